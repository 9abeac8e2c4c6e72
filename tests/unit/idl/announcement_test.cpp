// What participants announce, as a discovery server reads it.
#include "idl/announcement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "idl/datagram_guard.h"
#include "idl/participant.h"
#include "idl/server_places.h"
#include "tests/support/effort.h"
#include "tests/support/udp_ear.h"

namespace mortise {
namespace {

constexpr std::uint32_t kHere = 0x7f000001;
constexpr int kDomain = 231;

std::string key_of(const Announcement& told) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string key;
  for (const std::byte b : told.participant) {
    key += kDigits[std::to_integer<int>(b) >> 4];
    key += kDigits[std::to_integer<int>(b) & 15];
  }
  return key;
}

/// As a discovery server reads it: Fast DDS hangs statistics on, which the guard cuts off.
std::optional<Announcement> read(std::vector<std::byte> datagram) {
  datagram.resize(admissible_length(datagram));
  return read_announcement(datagram);
}

TEST(Announcements, OfAParticipantSayWhoItIsWhatForAndWhereItHears) {
  const test::UdpEar ear;
  DdsOptions options;
  options.domain = kDomain;
  options.session = "hall 3, left";
  options.discovery_server = ear.place();
  options.discovery_port = test::UdpEar().port();  // free, and nobody's
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
    const auto words = read(last);
    left = words && words->leaves && key_of(*words) == key;
  }
  EXPECT_TRUE(left) << "it says so when it goes";
}

/// A client's announcement, as a discovery server gets it.
class Announced : public ::testing::Test {
 protected:
  void SetUp() override {
    options_.domain = kDomain;
    options_.discovery_server = ear_.place();
    auto client = Participant::open(options_, Participant::Side::kClient, nullptr);
    ASSERT_TRUE(client) << client.error().text;
    client_ = std::move(*client);
    whole_ = ear_.next();
    whole_.resize(admissible_length(whole_));  // Fast DDS hangs statistics on
    ASSERT_TRUE(read_announcement(whole_));
  }
  /// With submessages behind it, or before.
  static bool is_read(const std::vector<std::byte>& datagram) {
    EXPECT_EQ(admissible_length(datagram), datagram.size()) << "the guard lets it through";
    return read_announcement(datagram).has_value();
  }
  static std::vector<std::byte> bytes(std::initializer_list<int> values) {
    std::vector<std::byte> all;
    for (const int value : values) all.push_back(static_cast<std::byte>(value));
    return all;
  }
  auto find(std::initializer_list<int> begin) {
    const auto wanted = bytes(begin);
    return std::search(whole_.begin(), whole_.end(), wanted.begin(), wanted.end());
  }
  /// Where the submessage DATA begins. A byte like its number may stand anywhere before.
  std::size_t data_at() const {
    for (std::size_t at = 20; at + 4 <= whole_.size();) {
      if (whole_[at] == std::byte{0x15}) return at;
      std::uint16_t length = 0;
      std::memcpy(&length, &whole_[at + 2], sizeof length);
      at += 4u + length;
    }
    ADD_FAILURE() << "no DATA in the announcement";
    return 20;
  }
  /// DATA, which is the last submessage, reaches to the end of the datagram.
  void stretch_data() { whole_[data_at() + 2] = whole_[data_at() + 3] = std::byte{0}; }
  test::UdpEar ear_;
  DdsOptions options_;
  std::unique_ptr<Participant> client_;
  std::vector<std::byte> whole_;
};

TEST_F(Announced, TellNothingWhereNoDiscoveryServerIsNamed) {
  auto told = read_announcement(whole_);
  EXPECT_EQ(told->purpose, (Purpose{false, kDomain, "default"}));
  client_.reset();
  options_.discovery_server.clear();
  options_.discovery_port = ear_.port();  // as if it were the server
  auto client = Participant::open(options_, Participant::Side::kClient, nullptr);
  ASSERT_TRUE(client) << client.error().text;
  told.reset();
  for (int i = 0; i < 100 && (!told || key_of(*told) != (*client)->key()); ++i)
    told = read(ear_.next());
  ASSERT_TRUE(told);
  EXPECT_EQ(key_of(*told), (*client)->key());
  EXPECT_FALSE(told->purpose);
}

TEST_F(Announced, NameSomePlacesAndNoMore) {
  EXPECT_FALSE(read_announcement(whole_)->hears_otherwise);
  const auto found = find({0x32, 0, 24, 0, 1, 0, 0, 0});
  ASSERT_NE(found, whole_.end());
  const std::vector<std::byte> place(found, found + 28);
  for (int i = 0; i < 20; ++i) whole_.insert(whole_.end() - 4, place.begin(), place.end());
  stretch_data();
  ASSERT_TRUE(is_read(whole_));
  const auto told = read_announcement(whole_);
  EXPECT_EQ(told->places.size(), 8u);
  EXPECT_TRUE(told->hears_otherwise);
}

TEST_F(Announced, NameEveryPlaceWhereTheyHear) {
  ASSERT_NE(find({0x31, 0, 24, 0, 1, 0, 0, 0}), whole_.end());
  const auto own = read_announcement(whole_);
  ASSERT_EQ(own->inboxes.size(), 1u);
  EXPECT_EQ(own->inboxes.front().ipv4, kHere);
  for (const int parameter : {0x30, 0x33}) {  // multicast
    auto other = whole_;
    const auto at = find({0x31, 0, 24, 0, 1, 0, 0, 0}) - whole_.begin();
    other[static_cast<std::size_t>(at)] = static_cast<std::byte>(parameter);
    EXPECT_TRUE(read_announcement(other)->hears_otherwise) << parameter;
  }
  const auto at = static_cast<std::size_t>(find({0x31, 0, 24, 0, 1, 0, 0, 0}) - whole_.begin());
  whole_[at + 4] = std::byte{2};  // UDP over IPv6
  EXPECT_TRUE(read_announcement(whole_)->hears_otherwise);
}

/// What is passed on speaks for nobody but who sent it.
TEST_F(Announced, AreOfWhoSendsThemAndNothingElse) {
  ASSERT_TRUE(is_read(whole_));
  auto other = whole_;
  other[10] ^= std::byte{1};  // the header's name, not the one that is announced
  EXPECT_FALSE(is_read(other));
  other = whole_;
  const auto guid = static_cast<std::size_t>(find({0x50, 0, 16, 0}) - whole_.begin());
  ASSERT_LT(guid, whole_.size());
  other[guid + 6] ^= std::byte{1};
  EXPECT_FALSE(is_read(other));

  const auto heartbeat = bytes({0x07, 1, 28, 0, 0, 1, 0, 0xc7, 0, 1, 0, 0xc2, 0, 0, 0, 0,
                                1,    0, 0,  0, 0, 0, 0, 0,    1, 0, 0, 0,    1, 0, 0, 0});
  other = whole_;
  other.insert(other.end(), heartbeat.begin(), heartbeat.end());
  EXPECT_FALSE(is_read(other)) << "with more behind it";
  std::vector<std::byte> source = bytes({0x0c, 1, 20, 0, 0, 0, 0, 0, 2, 3, 1, 15});
  source.resize(24, std::byte{7});
  other = whole_;
  other.insert(other.begin() + 20, source.begin(), source.end());
  EXPECT_FALSE(is_read(other)) << "said to be of another";
  other = whole_;
  other.insert(other.end(), whole_.begin() + static_cast<std::ptrdiff_t>(data_at()), whole_.end());
  EXPECT_FALSE(is_read(other)) << "two of them";
}

TEST_F(Announced, OfWhateverBytesAreReadWithoutHarm) {
  std::mt19937 random(11);
  std::size_t read = 0, guarded = 0;
  for (int i = 0; i < 200'000 * test::effort(1); ++i) {
    auto bytes = whole_;
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

}  // namespace
}  // namespace mortise
