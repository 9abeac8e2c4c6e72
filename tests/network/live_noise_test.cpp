// Noise on a session in progress: the real server, bots and participants, and mutations of what
// they really say to each other, in the names in which they say it.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "tests/network/domain.h"
#include "tests/network/key_ring.h"
#include "tests/network/noise.h"
#include "tests/network/program.h"
#include "tests/network/same_everywhere.h"
#include "tests/network/wiretap.h"
#include "tests/support/effort.h"
#include "tests/support/small_scenarios.h"

namespace mortise::test {
namespace {

using Json = nlohmann::json;

class LiveNoise : public ::testing::Test {
 protected:
  void begin(const std::string& keys_of_server, const std::string& keys_of_bots,
             const std::string& keys_of_anna, const std::string& keys_of_ben) {
    tap_ = std::make_unique<Wiretap>(port_, kPorts);
    if (!tap_->works()) GTEST_SKIP() << "not root: no raw sockets, the session cannot be recorded";
    log_ = (folder_.path() / "noise.mcap").string();
    server_ = start("mortise-server",
                    {folder_.write("blocks.yaml", blocks_yaml()), "--log", log_, "--json"},
                    keys_of_server);
    anna_ = std::make_unique<Guest>(domain_, "anna", "designer", keys_of_anna);
    ben_ = std::make_unique<Guest>(domain_, "ben", "designer", keys_of_ben);
    ASSERT_TRUE(is_in(*anna_) && is_in(*ben_)) << server_->errors();
    ASSERT_TRUE(grab_red()) << server_->errors();
    red_ = anna_->client->find_part("red");
    bots_ = start("mortise-bot",
                  {"--wait", "20", "--names", "crew", "--part", "blue", "--behaviour", "wander",
                   "--duration", "3000", "--json"},
                  keys_of_bots);
    ASSERT_TRUE(until(20, [&] { return bool(ben_->holder("blue")); })) << bots_->errors();
    // Only of what is said from here on: before, they shook hands.
    tap_->take();
    for (int i = 0; i < 60; ++i) move(*anna_);
    seeds_ = tap_->take();
    ASSERT_GT(seeds_.size(), 100u) << "the session says next to nothing";
    EXPECT_GT(to_clients(seeds_), seeds_.size() / 10) << "the clients' ports are others";
    EXPECT_LT(to_clients(seeds_), seeds_.size() * 9 / 10) << "the server's ports are others";
  }
  std::unique_ptr<Program> start(const char* program, std::vector<std::string> arguments,
                                 const std::string& keys) {
    arguments.insert(arguments.end(), {"--domain", std::to_string(domain_)});
    if (!keys.empty()) arguments.insert(arguments.end(), {"--keys", keys});
    return std::make_unique<Program>(folder_.path(), program, arguments);
  }
  std::size_t to_clients(const std::vector<Wiretap::Heard>& seeds) const {
    return static_cast<std::size_t>(std::count_if(
        seeds.begin(), seeds.end(),
        [&](const Wiretap::Heard& heard) { return heard.port >= port_ + kPortsOfServers; }));
  }
  bool until(double limit_s, const std::function<bool()>& done) {
    return anna_->until(limit_s, [&] {
      ben_->listen();
      return done();
    });
  }
  bool is_in(const Guest& guest) {
    return until(20, [&] { return guest.client->user_id(guest.user) && guest.client->synced(); });
  }
  /// She may have been starved by who came in beside her, and have to join again.
  bool grab_red() {
    for (int tries = 0; tries < 5; ++tries) {
      anna_->client->grab(anna_->user, anna_->client->find_part("red"));
      if (until(3, [&] {
            return anna_->holder("red") && anna_->holder("red") == anna_->client->user_id(0);
          }))
        return true;
    }
    return false;
  }
  /// Red to and fro.
  void move(Guest& guest) {
    last_ = guest.client->send(guest.user, red_, {++moves_ % 2 != 0 ? 0.5 : -0.5, 0, 0});
    until(0.01, [] { return false; });
  }
  /// The session goes on meanwhile, as well as it can.
  void make_noise(std::uint64_t seed, const std::vector<Wiretap::Heard>& seeds, int datagrams,
                  int at_once = 250) {
    std::mt19937_64 random(seed);
    Socket mouth(0);
    const std::uint64_t overflowed = overflowed_at(port_, kPorts);
    const double begin_s = steady_s();
    for (int i = 0; i < datagrams; ++i) {
      const Wiretap::Heard& heard = seeds[random() % seeds.size()];
      mouth.send(mutate(Datagram(heard.bytes.begin(), heard.bytes.end()), random), heard.port);
      if (i % at_once == 0) move(*anna_);  // and sockets do not overflow
      if (i % 5000 == 0) {
        ASSERT_TRUE(server_->running()) << i << ": " << server_->errors();
        ASSERT_TRUE(bots_->running()) << i << ": " << bots_->errors();
      }
    }
    EXPECT_TRUE(server_->running()) << server_->errors();
    EXPECT_TRUE(bots_->running()) << bots_->errors();
    const std::uint64_t missed = overflowed_at(port_, kPorts) - overflowed;
    std::printf("%d mutations of %zu datagrams (%zu of them to clients) in %.1f s, %llu too many\n",
                datagrams, seeds.size(), to_clients(seeds), steady_s() - begin_s,
                static_cast<unsigned long long>(missed));
    std::printf("anna's guard dropped %llu\n",
                static_cast<unsigned long long>(anna_->channel->counters().guard_dropped));
    EXPECT_GT(anna_->channel->counters().guard_dropped, 0u) << "the noise does not reach clients";
    // Whom each of them might be takes long to find out.
    if (&seeds == &seeds_) {
      EXPECT_LT(missed, static_cast<std::uint64_t>(datagrams) / 50) << "they never got there";
    }
  }
  Json end() {
    server_->signal(SIGTERM);
    EXPECT_EQ(server_->wait(10), 0) << server_->errors();
    Json closing = Json::parse(server_->out());
    const Json& channel = closing["channel"];
    std::printf("the server's guard dropped %s; malformed %s, foreign %s\n",
                channel["guard_dropped"].dump().c_str(), channel["malformed"].dump().c_str(),
                channel["foreign"].dump().c_str());
    EXPECT_GT(channel["guard_dropped"].get<int>(), 0) << "the noise does not reach the server";
    return closing;
  }

  static constexpr int kPorts = 20;          ///< the server and the participants after it
  static constexpr int kPortsOfServers = 4;  ///< at the front of them
  TestFolder folder_;
  const int domain_ = own_domain(), port_ = 7402 + 250 * domain_;
  int moves_ = 0;
  std::unique_ptr<Wiretap> tap_;
  std::string log_;
  std::unique_ptr<Program> server_, bots_;
  std::unique_ptr<Guest> anna_, ben_;
  PartId red_;
  std::uint64_t last_ = 0;  ///< sequence of her last move
  std::vector<Wiretap::Heard> seeds_;
};

// Without keys whatever is said in somebody's name counts as said by them, also the number of their
// next sample: who was there may be deaf for the rest of the session. But no process ends, and with
// whom it comes anew the session works.
TEST_F(LiveNoise, SoakNoProcessEndsAndTheSessionWorks) {
  begin("", "", "", "");
  if (IsSkipped() || HasFatalFailure()) return;
  make_noise(2718, seeds_, effort(250'000));
  bots_->signal(SIGTERM);
  EXPECT_EQ(bots_->wait(20), 0) << bots_->errors();
  anna_ = std::make_unique<Guest>(domain_, "late");
  ben_ = std::make_unique<Guest>(domain_, "later");
  ASSERT_TRUE(is_in(*anna_) && is_in(*ben_)) << server_->errors();
  ASSERT_TRUE(until(8, [&] { return !anna_->holder("red"); }));
  ASSERT_TRUE(grab_red());
  for (int i = 0; i < 100; ++i) move(*anna_);
  ASSERT_TRUE(until(5, [&] { return anna_->taken.contains(last_); }));
  EXPECT_EQ(anna_->refused.size(), 0u);
  const Knowledge known = agreed_by({anna_.get(), ben_.get()});
  const Json closing = end();
  expect_told_at_end(known, closing);
  expect_in_log(known, log_, {anna_.get(), ben_.get()});
}

// With keys whatever is encrypted is genuine or nothing, and who was there does not even notice.
// How participants announce themselves is in the clear: noise there may part them, but no process
// ends, and with whom it comes anew the session works.
TEST_F(LiveNoise, SoakWithKeysNobodyNotices) {
  KeyRing keys("site");
  keys.issue("hall", "server");
  for (const char* name : {"anna", "ben", "late", "later"}) keys.issue(name, "designer");
  keys.issue("crew", "bot");
  ASSERT_EQ(keys.trouble(), "");
  begin(keys["hall"], keys["crew"], keys["anna"], keys["ben"]);
  if (IsSkipped() || HasFatalFailure()) return;
  const auto in_the_clear =
      std::partition(seeds_.begin(), seeds_.end(), [](const Wiretap::Heard& heard) {
        constexpr char kEncrypted = 0x33;
        return heard.bytes.size() > 20 && heard.bytes[20] == kEncrypted;
      });
  const std::vector<Wiretap::Heard> announcements(in_the_clear, seeds_.end());
  seeds_.erase(in_the_clear, seeds_.end());
  ASSERT_GT(seeds_.size(), 100u);
  ASSERT_GT(announcements.size(), 3u);

  const std::size_t said_before = server_->errors().size();
  make_noise(2719, seeds_, effort(240'000));
  ASSERT_TRUE(until(5, [&] { return anna_->taken.contains(last_); })) << server_->errors();
  EXPECT_EQ(anna_->holder("red"), anna_->client->user_id(anna_->user));
  EXPECT_EQ(anna_->taken.size(), anna_->client->statistics().increments_sent);
  EXPECT_EQ(anna_->refused.size(), 0u);
  EXPECT_EQ(server_->errors().find("without goodbye", said_before), std::string::npos)
      << server_->errors();
  EXPECT_EQ(anna_->client->statistics().server_losses, 0u);
  agreed_by({anna_.get(), ben_.get()});

  make_noise(2720, announcements, effort(10'000), 20);
  bots_->signal(SIGTERM);
  EXPECT_EQ(bots_->wait(20), 0) << bots_->errors();
  const std::unique_ptr<Guest> first = std::move(anna_);
  anna_ = std::make_unique<Guest>(domain_, "late", "designer", keys["late"]);
  ben_ = std::make_unique<Guest>(domain_, "later", "designer", keys["later"]);
  ASSERT_TRUE(is_in(*anna_) && is_in(*ben_)) << server_->errors();
  first->client->release(first->user, red_);
  ASSERT_TRUE(until(8, [&] {
    first->listen();
    return !anna_->holder("red");
  })) << server_->errors();
  ASSERT_TRUE(grab_red());
  anna_->client->send(anna_->user, red_, {0, 0, -12});  // into the base
  ASSERT_TRUE(until(5, [&] { return !ben_->client->open_clashes().empty(); }));
  const Knowledge known = agreed_by({anna_.get(), ben_.get()});
  const Json closing = end();
  expect_told_at_end(known, closing);
  expect_in_log(known, log_, {first.get(), anna_.get(), ben_.get()});
  expect_nothing_lost(*anna_, "late", closing);
}

}  // namespace
}  // namespace mortise::test
