// The datagram guard: real shapes pass, each known killer is dropped, and no bytes lead it astray.
#include "idl/datagram_guard.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "idl/peers_heard.h"
#include "idl/rtps_bytes.h"

namespace mortise {
namespace {

using Datagram = std::vector<std::uint8_t>;

std::size_t admitted(const Datagram& datagram) {
  return admissible_length(std::as_bytes(std::span(datagram)));
}

void put16(Datagram& out, std::uint16_t value) {
  out.push_back(static_cast<std::uint8_t>(value));
  out.push_back(static_cast<std::uint8_t>(value >> 8));
}
void put32(Datagram& out, std::uint32_t value) {
  put16(out, static_cast<std::uint16_t>(value));
  put16(out, static_cast<std::uint16_t>(value >> 16));
}
void put_sequence(Datagram& out, std::int64_t value) {
  put32(out, static_cast<std::uint32_t>(static_cast<std::uint64_t>(value) >> 32));
  put32(out, static_cast<std::uint32_t>(value));
}

/// RTPS 2.2 header of some participant.
Datagram header() {
  Datagram out = {'R', 'T', 'P', 'S', 2, 2, 1, 15};
  for (int i = 0; i < 12; ++i) out.push_back(static_cast<std::uint8_t>(i));
  return out;
}

Datagram with(Datagram out, std::uint8_t id, std::uint8_t flags, const Datagram& body) {
  out.push_back(id);
  out.push_back(flags);
  put16(out, static_cast<std::uint16_t>(body.size()));
  out.insert(out.end(), body.begin(), body.end());
  return out;
}

struct DataFields {
  std::uint16_t octets_to_qos = 16;
  std::int64_t sequence = 7;
  std::uint8_t encapsulation = 1;  // CDR little endian
  std::uint16_t parameter = 0;     // of a parameter list payload; 0: plain payload
  bool sentinel = true;
};

Datagram data_body(const DataFields& fields = {}) {
  Datagram body;
  put16(body, 0);
  put16(body, fields.octets_to_qos);
  put32(body, 0x0000'03c7);
  put32(body, 0x0000'03c2);
  put_sequence(body, fields.sequence);
  body.insert(body.end(), {0, fields.encapsulation, 0, 0});
  if (fields.parameter == 0) {
    put32(body, 42);
  } else {
    put16(body, fields.parameter);
    put16(body, 4);
    put32(body, 1);
    if (fields.sentinel) put32(body, 1);
  }
  return body;
}

Datagram heartbeat_body(std::int64_t first, std::int64_t last) {
  Datagram body;
  put32(body, 1);
  put32(body, 2);
  put_sequence(body, first);
  put_sequence(body, last);
  put32(body, 9);
  return body;
}

Datagram gap_body(std::int64_t start, std::int64_t base, std::uint32_t bits, int words) {
  Datagram body;
  put32(body, 1);
  put32(body, 2);
  put_sequence(body, start);
  put_sequence(body, base);
  put32(body, bits);
  for (int i = 0; i < words; ++i) put32(body, 0xffffffff);
  return body;
}

Datagram acknack_body(std::int64_t base, std::uint32_t bits, int words) {
  Datagram body;
  put32(body, 1);
  put32(body, 2);
  put_sequence(body, base);
  put32(body, bits);
  for (int i = 0; i < words; ++i) put32(body, 0xffffffff);
  put32(body, 3);
  return body;
}

Datagram frag_body(std::uint32_t first, std::uint16_t count, std::uint16_t size,
                   std::uint32_t sample) {
  Datagram body;
  put16(body, 0);
  put16(body, 28);
  put32(body, 1);
  put32(body, 2);
  put_sequence(body, 5);
  put32(body, first);
  put16(body, count);
  put16(body, size);
  put32(body, sample);
  put32(body, 0);
  return body;
}

/// What a session really sends: time, destination, data, heartbeat.
Datagram ordinary() {
  Datagram out = with(header(), 0x0e, 1, Datagram(12, 3));
  out = with(out, 0x09, 1, Datagram(8, 1));
  out = with(out, 0x15, 5, data_body());
  DataFields discovery;
  discovery.encapsulation = 3;
  discovery.parameter = 0x50;
  out = with(out, 0x15, 5, data_body(discovery));
  out = with(out, 0x07, 1, heartbeat_body(1, 7));
  out = with(out, 0x06, 1, acknack_body(4, 32, 1));
  return with(out, 0x08, 1, gap_body(3, 5, 0, 0));
}

struct SecureFields {
  std::uint8_t prefix = 0x33, body = 0x30, postfix = 0x34;
  std::size_t header_size = 20;
  std::uint32_t length = 77, padding = 3;  ///< of what is encrypted; as it is said and as it is
  int missing = 0;                         ///< of these bytes
  std::uint32_t macs = 1;                  ///< of receivers, as it is said; there is one
};

/// An encrypted datagram.
Datagram encrypted(const SecureFields& fields = {}) {
  const auto put32_big = [](Datagram& out, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8)
      out.push_back(static_cast<std::uint8_t>(value >> shift));
  };
  Datagram body, postfix(16, 7);
  put32_big(body, fields.length);
  body.resize(4 + 77 + fields.padding - static_cast<std::size_t>(fields.missing), 9);
  put32_big(postfix, fields.macs);
  postfix.resize(postfix.size() + 20, 5);
  Datagram out = with(header(), fields.prefix, 1, Datagram(fields.header_size, 8));
  if (fields.body != 0) out = with(out, fields.body, 1, body);
  return fields.postfix == 0 ? out : with(out, fields.postfix, 1, postfix);
}

TEST(Guard, EncryptedTrafficPassesWhole) {
  EXPECT_EQ(admitted(encrypted()), encrypted().size());
  const Datagram submessage = encrypted({.prefix = 0x31, .postfix = 0x32});  // of a handshake
  EXPECT_EQ(admitted(submessage), submessage.size());
  EXPECT_EQ(admitted(with(submessage, 0x07, 1, heartbeat_body(1, 7))), submessage.size() + 32);
  EXPECT_EQ(admitted(with(encrypted(), 0x80, 1, Datagram(8, 0))), encrypted().size());
}

Datagram announcement(std::uint16_t parameter, const Datagram& value) {
  DataFields fields;
  fields.encapsulation = 3;
  Datagram body = data_body(fields);
  body.resize(body.size() - 4);
  put16(body, parameter);
  put16(body, static_cast<std::uint16_t>(value.size()));
  body.insert(body.end(), value.begin(), value.end());
  put32(body, 1);
  return with(header(), 0x15, 5, body);
}

// Lengths inside what is announced: of texts, of properties, of tokens.
TEST(Guard, WhatIsAnnouncedIsNoLongerThanItsParameter) {
  const auto drops = [](std::uint16_t parameter, const Datagram& value) {
    return admitted(announcement(parameter, value)) == 0;
  };
  Datagram token;
  const auto put_text = [&](const std::string& text) {
    put32(token, static_cast<std::uint32_t>(text.size()) + 1);
    for (const char c : text) token.push_back(static_cast<std::uint8_t>(c));
    do token.push_back(0);
    while (token.size() % 4 != 0);
  };
  put_text("DDS:Auth:PKI-DH:1.0");
  const std::size_t at_properties = token.size();
  put32(token, 1);
  put_text("dds.cert.sn");
  const std::size_t at_value = token.size();
  put_text("anna");
  const std::size_t at_binary = token.size();
  put32(token, 0);
  for (const std::uint16_t id :
       {std::uint16_t{0x1001}, std::uint16_t{0x1002}, std::uint16_t{0x1006}}) {
    EXPECT_FALSE(drops(id, token));
    EXPECT_TRUE(drops(id, Datagram(token.begin(), token.end() - 4)));
    for (const std::size_t at : {std::size_t{0}, at_properties, at_value, at_binary}) {
      for (const int byte : {0, 1, 3}) {
        Datagram wrong = token;
        wrong[at + static_cast<std::size_t>(byte)] = 0xff;
        EXPECT_TRUE(drops(id, wrong)) << at << " " << byte;
      }
    }
  }
  const auto end = [&](std::size_t at) { return token.begin() + static_cast<std::ptrdiff_t>(at); };
  const Datagram list(end(at_properties), end(at_binary));
  EXPECT_FALSE(drops(0x59, list));
  EXPECT_TRUE(drops(0x59, Datagram(list.begin(), list.end() - 4)));
  EXPECT_FALSE(drops(0x2c, {2, 0, 0, 0, 7, 7, 0, 0}));
  EXPECT_TRUE(drops(0x2c, {5, 0, 0, 0, 7, 7, 0, 0}));
}

// Fast DDS decrypts as much as is said to be there.
TEST(Guard, LengthsOfWhatIsEncryptedAreThoseOfTheDatagram) {
  const auto drops = [](const SecureFields& fields) { return admitted(encrypted(fields)) == 0; };
  EXPECT_TRUE(drops({.header_size = 24}));
  EXPECT_TRUE(drops({.header_size = 16}));
  EXPECT_TRUE(drops({.length = 81}));
  EXPECT_TRUE(drops({.length = 76}));
  EXPECT_TRUE(drops({.length = 0x0100'004d}));
  EXPECT_TRUE(drops({.length = 0xffff'ffff}));  // with the size of a block it is small again
  EXPECT_TRUE(drops({.length = 77, .padding = 3, .missing = 4}));
  EXPECT_TRUE(drops({.macs = 0}));
  EXPECT_TRUE(drops({.macs = 2}));
  EXPECT_TRUE(drops({.macs = 0x0ccc'ccce}));  // times 20 it is small again
}

TEST(Guard, WhatIsEncryptedIsPrefixBodyAndPostfix) {
  const auto drops = [](const SecureFields& fields) { return admitted(encrypted(fields)) == 0; };
  EXPECT_TRUE(drops({.postfix = 0x32}));
  EXPECT_TRUE(drops({.prefix = 0x31}));
  EXPECT_TRUE(drops({.body = 0x01}));
  EXPECT_TRUE(drops({.body = 0}));
  EXPECT_TRUE(drops({.postfix = 0}));
  EXPECT_TRUE(drops({.postfix = 0x80}));
  EXPECT_TRUE(drops({.body = 0, .postfix = 0}));
  EXPECT_TRUE(drops({.prefix = 0x01}));
  EXPECT_TRUE(drops({.prefix = 0x35}));
  EXPECT_EQ(admitted(with(encrypted(), 0x34, 1, Datagram(20, 0))), 0u);
}

TEST(Guard, OrdinaryTrafficPassesWhole) {
  EXPECT_EQ(admitted(ordinary()), ordinary().size());
  EXPECT_EQ(admitted(header()), header().size());
  EXPECT_EQ(admitted(with(header(), 0x16, 5, frag_body(1, 1, 1000, 5000))), 60u);
  EXPECT_EQ(admitted(with(header(), 0x07, 1, heartbeat_body(1, 0))), 52u);  // nothing written yet
  EXPECT_EQ(admitted(with(header(), 0x01, 1, {})), 24u);
}

TEST(Guard, StatisticsAreCutOff) {
  const Datagram whole = ordinary();
  const Datagram statistics = with(whole, 0x80, 1, Datagram(8, 0));
  EXPECT_EQ(admitted(statistics), whole.size());
  EXPECT_EQ(admitted(with(header(), 0x80, 1, Datagram(8, 0))), 0u);
}

TEST(Guard, KnownKillersAreDropped) {
  const auto drops = [](const Datagram& datagram) { return admitted(datagram) == 0; };
  EXPECT_TRUE(drops({}));
  EXPECT_TRUE(drops(Datagram(19, 'R')));
  Datagram other_version = ordinary();
  other_version[4] = 1;
  EXPECT_TRUE(drops(other_version));
  Datagram cut_short = ordinary();
  cut_short.pop_back();
  EXPECT_TRUE(drops(cut_short));
  Datagram trailing = ordinary();
  trailing.push_back(0);
  EXPECT_TRUE(drops(trailing));
  EXPECT_TRUE(drops(with(header(), 0x42, 1, Datagram(8, 0))));   // unknown submessage
  EXPECT_TRUE(drops(with(header(), 0x15, 5, Datagram(16, 0))));  // too short for its kind
  EXPECT_TRUE(drops(with(header(), 0x0c, 1, Datagram(16, 0))));

  DataFields fields;
  fields.octets_to_qos = 20;
  EXPECT_TRUE(drops(with(header(), 0x15, 5, data_body(fields))));
  fields = {};
  fields.sequence = std::int64_t{1} << 50;
  EXPECT_TRUE(drops(with(header(), 0x15, 5, data_body(fields))));
  fields.sequence = -1;
  EXPECT_TRUE(drops(with(header(), 0x15, 5, data_body(fields))));
  fields = {};
  fields.encapsulation = 9;
  EXPECT_TRUE(drops(with(header(), 0x15, 5, data_body(fields))));
  for (const std::uint16_t type_parameter : {std::uint16_t{0x69}, std::uint16_t{0x72}}) {
    fields = {};
    fields.encapsulation = 3;
    fields.parameter = type_parameter;
    EXPECT_TRUE(drops(with(header(), 0x15, 5, data_body(fields))));
  }
  fields = {};
  fields.encapsulation = 3;
  fields.parameter = 0x50;
  fields.sentinel = false;
  EXPECT_TRUE(drops(with(header(), 0x15, 5, data_body(fields))));

  EXPECT_TRUE(drops(with(header(), 0x07, 1, heartbeat_body(0, 7))));
  EXPECT_TRUE(drops(with(header(), 0x07, 1, heartbeat_body(9, 7))));
  EXPECT_TRUE(drops(with(header(), 0x07, 1, heartbeat_body(1, 1'000'000'000))));
  EXPECT_TRUE(drops(with(header(), 0x08, 1, gap_body(1, 1'000'000'000, 0, 0))));  // eats memory
  EXPECT_TRUE(drops(with(header(), 0x08, 1, gap_body(5, 3, 0, 0))));
  EXPECT_TRUE(drops(with(header(), 0x08, 1, gap_body(1, 2, 512, 16))));
  EXPECT_TRUE(drops(with(header(), 0x08, 1, gap_body(1, 2, 64, 1))));  // bitmap not all there
  EXPECT_TRUE(drops(with(header(), 0x06, 1, acknack_body(4, 300, 10))));
  EXPECT_TRUE(drops(with(header(), 0x16, 5, frag_body(0, 1, 1000, 5000))));
  EXPECT_TRUE(drops(with(header(), 0x16, 5, frag_body(6, 1, 1000, 5000))));
  EXPECT_TRUE(drops(with(header(), 0x16, 5, frag_body(1, 1, 0, 5000))));
  EXPECT_TRUE(drops(with(header(), 0x16, 5, frag_body(0xffffffff, 0xffff, 0xffff, 1))));
}

TEST(Guard, BigEndianIsReadAsSuch) {
  Datagram body = {0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0,
                   0, 1, 0, 0, 0, 0, 0, 0, 0, 7, 0, 0, 0, 9};
  Datagram datagram = header();
  datagram.insert(datagram.end(), {0x07, 0, 0, 28});
  datagram.insert(datagram.end(), body.begin(), body.end());
  EXPECT_EQ(admitted(datagram), datagram.size());
  datagram[datagram.size() - 20] = 1;  // first sequence beyond 2^48
  EXPECT_EQ(admitted(datagram), 0u);
}

// Mutations: never out of bounds (each datagram lies at the end of its own allocation, which a
// sanitizer build checks), never more than came in, and what is admitted is admitted again.
TEST(Guard, MutatedDatagramsLeadNowhere) {
  std::mt19937_64 random(424242);
  const Datagram wholes[] = {ordinary(), encrypted()};
  std::size_t dropped = 0, passed = 0;
  for (int i = 0; i < 300'000; ++i) {
    Datagram mutated = wholes[i % 2];
    for (std::uint64_t change = 1 + random() % 4; change-- > 0 && !mutated.empty();) {
      const std::size_t at = random() % mutated.size();
      switch (random() % 4) {
        case 0:
          mutated[at] = static_cast<std::uint8_t>(random());
          break;
        case 1:
          mutated[at] = static_cast<std::uint8_t>(mutated[at] ^ (1u << random() % 8));
          break;
        case 2:
          mutated.resize(at);
          break;
        default:
          mutated[at] = 0xff;
      }
    }
    mutated.shrink_to_fit();
    const std::size_t length = admitted(mutated);
    ASSERT_LE(length, mutated.size());
    if (length == 0) {
      ++dropped;
      continue;
    }
    ++passed;
    mutated.resize(length);
    ASSERT_EQ(admitted(mutated), length);
  }
  EXPECT_GT(dropped, 50'000u);
  EXPECT_GT(passed, 10'000u);
}

// Whoever says nothing encrypted has forgotten us, however it announces itself in plain words.
TEST(PeersHeard, OneThatSpokeFallsSilent) {
  using std::chrono::seconds;
  const PeersHeard::Time begun;
  PeersHeard heard(seconds(4));
  PeersHeard::Prefix peer;
  for (std::size_t i = 0; i < peer.size(); ++i) peer[i] = static_cast<std::byte>(i);
  Datagram plain = header(), encrypted = header();
  plain.push_back(rtps_wire::kDataSubmessage);
  encrypted.push_back(0x33);
  const auto note = [&](const Datagram& datagram, int s) {
    heard.note(std::as_bytes(std::span(datagram)), begun + seconds(s));
  };
  const auto is_silent = [&](int s) { return heard.is_silent(peer, begun + seconds(s)); };
  note(encrypted, 0);  // nobody who counts
  EXPECT_FALSE(is_silent(100));
  heard.watch(peer, begun + seconds(100));
  EXPECT_TRUE(is_silent(105));
  note(encrypted, 103);
  EXPECT_FALSE(is_silent(106));
  note(plain, 107);
  EXPECT_TRUE(is_silent(108));
  heard.part(peer);
  note(encrypted, 109);
  EXPECT_FALSE(is_silent(200)) << "met anew, and has said nothing that counts";
}

}  // namespace
}  // namespace mortise
