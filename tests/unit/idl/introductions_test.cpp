// What participants announce, as a discovery server reads it, and who is told of whom.
#include "idl/introductions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "idl/datagram_guard.h"
#include "idl/directory.h"
#include "idl/participant.h"
#include "idl/server_places.h"
#include "tests/support/effort.h"
#include "tests/support/udp_ear.h"

namespace mortise {
namespace {

using Outcome = Introductions::Outcome;
constexpr std::uint32_t kHere = 0x7f000001, kThere = 0x0a000002;
constexpr int kDomain = 226;

std::string key_of(const Announcement& told) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string key;
  for (const std::byte b : told.participant) {
    key += kDigits[std::to_integer<int>(b) >> 4];
    key += kDigits[std::to_integer<int>(b) & 15];
  }
  return key;
}

TEST(Announcements, OfAParticipantSayWhoItIsWhatForAndWhereItHears) {
  const test::UdpEar ear;
  DdsOptions options;
  options.domain = kDomain;
  options.session = "hall 3, left";
  options.discovery_server = ear.place();
  auto participant = Participant::open(options, Participant::Side::kServer, nullptr);
  ASSERT_TRUE(participant) << participant.error().text;
  auto datagram = ear.next();
  datagram.resize(admissible_length(datagram));  // Fast DDS hangs statistics on
  const auto told = read_announcement(datagram);
  ASSERT_TRUE(told);
  EXPECT_EQ(key_of(*told), (*participant)->key());
  EXPECT_EQ(told->purpose, (Purpose{true, kDomain, "hall 3, left"}));
  const UdpPlace place{kHere, static_cast<std::uint16_t>(server_port(options))};
  EXPECT_EQ(told->places, std::vector{place});
  EXPECT_FALSE(told->leaves);

  const std::string key = (*participant)->key();
  participant->reset();
  bool left = false;
  for (auto last = ear.next(1000); !last.empty() && !left; last = ear.next(1000)) {
    const auto words = read_announcement(last);
    left = words && words->leaves && key_of(*words) == key;
  }
  EXPECT_TRUE(left) << "it says so when it goes";
}

TEST(Announcements, TellNothingWhereNoDiscoveryServerIsNamed) {
  const test::UdpEar ear;
  DdsOptions options;
  options.domain = kDomain;
  options.discovery_server = ear.place();
  auto client = Participant::open(options, Participant::Side::kClient, nullptr);
  ASSERT_TRUE(client) << client.error().text;
  auto told = read_announcement(ear.next());
  ASSERT_TRUE(told);
  EXPECT_EQ(told->purpose, (Purpose{false, kDomain, "default"}));

  options.discovery_server.clear();
  options.discovery_port = std::stoi(ear.place().substr(10));  // as if it were the server
  client = Participant::open(options, Participant::Side::kClient, nullptr);
  ASSERT_TRUE(client) << client.error().text;
  for (int i = 0; i < 100 && told && key_of(*told) != (*client)->key(); ++i)
    told = read_announcement(ear.next());
  ASSERT_TRUE(told);
  EXPECT_EQ(key_of(*told), (*client)->key());
  EXPECT_FALSE(told->purpose);
}

TEST(Announcements, NameSomePlacesAndNoMore) {
  const test::UdpEar ear;
  DdsOptions options;
  options.domain = kDomain;
  options.discovery_server = ear.place();
  auto client = Participant::open(options, Participant::Side::kClient, nullptr);
  ASSERT_TRUE(client) << client.error().text;
  auto datagram = ear.next();
  datagram.resize(admissible_length(datagram));
  const std::vector<std::byte> begin = {std::byte{0x32}, std::byte{0}, std::byte{24}, std::byte{0},
                                        std::byte{1},    std::byte{0}, std::byte{0},  std::byte{0}};
  const auto found = std::search(datagram.begin(), datagram.end(), begin.begin(), begin.end());
  ASSERT_NE(found, datagram.end());
  const std::vector<std::byte> place(found, found + 28);
  for (int i = 0; i < 20; ++i) datagram.insert(datagram.end() - 4, place.begin(), place.end());
  // DATA is the last submessage: its length is "to the end".
  for (std::size_t at = 20; at + 4 < datagram.size();) {
    std::uint16_t length = 0;
    std::memcpy(&length, &datagram[at + 2], sizeof length);
    if (datagram[at] == std::byte{0x15}) datagram[at + 2] = datagram[at + 3] = std::byte{0};
    at += 4u + (datagram[at] == std::byte{0x15} ? datagram.size() : length);
  }
  ASSERT_EQ(admissible_length(datagram), datagram.size());
  const auto told = read_announcement(datagram);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->places.size(), 8u);
}

TEST(Announcements, OfWhateverBytesAreReadWithoutHarm) {
  const test::UdpEar ear;
  DdsOptions options;
  options.domain = kDomain;
  options.discovery_server = ear.place();
  auto client = Participant::open(options, Participant::Side::kClient, nullptr);
  ASSERT_TRUE(client) << client.error().text;
  const auto whole = ear.next();
  ASSERT_TRUE(read_announcement(whole));
  std::mt19937 random(11);
  std::size_t read = 0, guarded = 0;
  for (int i = 0; i < 200'000 * test::effort(1); ++i) {
    auto bytes = whole;
    for (std::size_t n = 1 + random() % 8; n > 0; --n)
      bytes[random() % bytes.size()] = static_cast<std::byte>(random() & 0xff);
    if (random() % 4 == 0) bytes.resize(random() % bytes.size());
    bytes.shrink_to_fit();  // a sanitizer sees what is read behind its end
    const auto told = read_announcement(bytes);
    if (!told) continue;
    ++read;
    guarded += admissible_length(bytes) > 0 ? 1 : 0;
    EXPECT_LE(told->places.size(), 8u);
    if (told->purpose) {
      EXPECT_TRUE(told->purpose->domain >= 0 && told->purpose->domain <= 232);
      EXPECT_TRUE(!told->purpose->session.empty() && told->purpose->session.size() <= 128);
    }
  }
  EXPECT_GT(read, 10'000u);
  EXPECT_GT(guarded, 10'000u);
}

TEST(Purposes, AreReadAsTheyWereWritten) {
  for (const Purpose& purpose : {Purpose{true, 0, "a"}, Purpose{false, 232, "*"},
                                 Purpose{false, 7, " two words "}, Purpose{true, 1, "7 x"}})
    EXPECT_EQ(purpose_of(to_text(purpose)), purpose);
  for (const char* text :
       {"", "mortise", "mortise server", "mortise server ", "mortise server x a",
        "mortise server 233 a", "mortise server -1 a", "mortise server 7", "mortise server 7 ",
        "mortise looker 7 a", "Mortise server 7 a", "mortise server 99999999999 a"})
    EXPECT_FALSE(purpose_of(text)) << text;
  EXPECT_FALSE(purpose_of("mortise client 7 " + std::string(129, 'a')));
}

/// Participants with a place of their own each.
class Introduced : public ::testing::Test {
 protected:
  static Announcement of(int number, bool serves, const std::string& session, int domain = 0) {
    Announcement told;
    std::memcpy(told.participant.data(), &number, sizeof number);
    told.purpose = Purpose{serves, domain, session};
    told.places = {{kHere, static_cast<std::uint16_t>(number)}};
    return told;
  }
  Introductions::Answer take(const Announcement& told, std::uint32_t from = kHere) {
    return introductions_.take(told, from, now_s_);
  }
  std::vector<int> ports(const Announcement& told) {
    std::vector<int> all;
    for (const UdpPlace& place : take(told).to) all.push_back(place.port);
    std::sort(all.begin(), all.end());
    return all;
  }
  Introductions introductions_;
  double now_s_ = 100.0;
};

TEST_F(Introduced, AreServersAndClientsOfOneSession) {
  const auto server = of(1, true, "hall"), second = of(2, true, "hall"),
             other = of(3, true, "yard"), anna = of(11, false, "hall"), ben = of(12, false, "hall"),
             cleo = of(13, false, "yard"), looker = of(20, false, kEverySession),
             far = of(21, true, "hall", 5);
  for (const auto& told : {server, second, other, anna, ben, cleo, looker, far})
    EXPECT_TRUE(take(told).is_new);
  using Ports = std::vector<int>;
  EXPECT_EQ(ports(server), (Ports{2, 11, 12, 20}));
  EXPECT_EQ(ports(second), (Ports{1, 11, 12, 20}));
  EXPECT_EQ(ports(other), (Ports{13, 20}));
  EXPECT_EQ(ports(anna), (Ports{1, 2})) << "and no other client";
  EXPECT_EQ(ports(cleo), (Ports{3}));
  EXPECT_EQ(ports(looker), (Ports{1, 2, 3}));
  EXPECT_EQ(ports(far), Ports{}) << "another domain";
  EXPECT_EQ(introductions_.size(), 8u);
  EXPECT_EQ(introductions_.servers(), 4u);
}

TEST_F(Introduced, AreForgottenWhenTheyLeaveOrAreSilent) {
  const auto server = of(1, true, "hall"), anna = of(11, false, "hall");
  take(server);
  take(anna);
  now_s_ += 2.0;
  take(anna);
  now_s_ += 2.0;
  const auto gone = introductions_.take_gone(now_s_);
  ASSERT_EQ(gone.size(), 1u);
  EXPECT_TRUE(gone.front().purpose.serves);
  EXPECT_EQ(gone.front().place.port, 1);
  EXPECT_TRUE(ports(anna).empty());
  Announcement leaves = anna;
  leaves.leaves = true;
  EXPECT_EQ(take(leaves, kThere).outcome, Outcome::kFromElsewhere) << "said by another";
  EXPECT_EQ(introductions_.size(), 1u);
  EXPECT_EQ(take(leaves).outcome, Outcome::kTaken);
  EXPECT_EQ(introductions_.size(), 0u);
  EXPECT_EQ(introductions_.sessions(), 0u);
  EXPECT_EQ(introductions_.take_gone(now_s_).size(), 1u);
  EXPECT_TRUE(introductions_.take_gone(now_s_).empty()) << "once";
}

TEST_F(Introduced, AreHeardFromTheirOwnHostOnly) {
  const auto anna = of(11, false, "hall");
  EXPECT_EQ(take(anna, kThere).outcome, Outcome::kFromElsewhere) << "names a host that is not its";
  EXPECT_EQ(introductions_.size(), 0u);
  EXPECT_EQ(take(anna).outcome, Outcome::kTaken);
  Announcement forged = anna;
  forged.places = {{kThere, 99}};
  EXPECT_EQ(take(forged, kThere).outcome, Outcome::kFromElsewhere) << "anna's name from elsewhere";
  forged = anna;
  forged.purpose->serves = true;
  EXPECT_EQ(take(forged).outcome, Outcome::kFromElsewhere) << "she is no server";
  EXPECT_EQ(ports(of(1, true, "hall")), std::vector<int>{11});
  Announcement nameless = of(12, false, "hall");
  nameless.purpose.reset();
  EXPECT_EQ(take(nameless).outcome, Outcome::kNoPurpose);
  EXPECT_EQ(take(of(13, true, kEverySession)).outcome, Outcome::kFromElsewhere)
      << "nobody serves all";
}

TEST_F(Introduced, AreBoundInNumberAndPace) {
  const auto anna = of(11, false, "hall");
  int taken = 0;
  for (int i = 0; i < 1000; ++i) {
    now_s_ += 0.001;
    taken += take(anna).outcome == Outcome::kTaken ? 1 : 0;
  }
  EXPECT_GE(taken, 58);
  EXPECT_LE(taken, 60) << "40 at once and 20 in the second";
  now_s_ += 0.5;
  EXPECT_EQ(take(anna).outcome, Outcome::kTaken);
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(take(of(100 + i, true, "hall")).is_new);
  EXPECT_EQ(take(of(108, true, "hall")).outcome, Outcome::kFull);
  EXPECT_EQ(take(of(108, true, "yard")).outcome, Outcome::kTaken);
  for (int i = 0; introductions_.size() < Introductions::kMost; ++i)
    ASSERT_EQ(take(of(1000 + i, false, "crowd")).outcome, Outcome::kTaken);
  EXPECT_EQ(take(of(999, false, "hall")).outcome, Outcome::kFull);
  EXPECT_EQ(take(anna).outcome, Outcome::kTaken) << "who is here stays";
}

/// Against the rule, asked of every pair.
TEST_F(Introduced, AgreeWithTheRuleInEveryCrowd) {
  std::mt19937 random(5);
  std::size_t introduced = 0;
  for (int round = 0; round < 50 * test::effort(1); ++round) {
    Introductions introductions;
    struct One {
      Announcement told;
      double heard_s;
    };
    std::vector<One> all;
    double now_s = 0.0;
    for (int step = 0; step < 300; ++step) {
      now_s += 0.05;
      const bool is_new = all.empty() || random() % 4 == 0;
      if (is_new) {
        const bool serves = random() % 5 == 0;
        const char* const sessions[] = {"a", "b", "c", kEverySession};
        all.push_back({of(static_cast<int>(all.size()) + 1, serves,
                          sessions[random() % (serves ? 3 : 4)], static_cast<int>(random() % 2)),
                       -100.0});
      }
      One& one = is_new ? all.back() : all[random() % all.size()];
      introductions.take_gone(now_s);
      const auto answer = introductions.take(one.told, kHere, now_s);
      if (answer.outcome == Outcome::kFull) continue;
      ASSERT_EQ(answer.outcome, Outcome::kTaken);
      one.heard_s = now_s;
      std::vector<UdpPlace> expected;
      for (const One& other : all) {
        const Purpose &a = *one.told.purpose, &b = *other.told.purpose;
        const bool is_here = &other != &one && now_s - other.heard_s <= Introductions::kSilence_s;
        const bool same =
            a.session == b.session || a.session == kEverySession || b.session == kEverySession;
        if (is_here && a.domain == b.domain && same && (a.serves || b.serves))
          expected.push_back(other.told.places.front());
      }
      auto told = answer.to;
      std::sort(told.begin(), told.end());
      std::sort(expected.begin(), expected.end());
      ASSERT_EQ(told, expected);
      introduced += told.size();
    }
  }
  EXPECT_GT(introduced, 10'000u);
}

}  // namespace
}  // namespace mortise
