#pragma once
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/io/log/log_chain.h"
#include "common/io/log/replay.h"
#include "common/io/log/session_log.h"
#include "server/restore.h"
#include "tests/network/domain.h"
#include "tests/network/guest.h"
#include "tests/network/program.h"
#include "tests/support/small_scenarios.h"

namespace mortise::test {

/// How long one client was without a word of the moving part.
class PoseGap {
 public:
  void restart() {
    longest_s_ = 0.0;
    seen_s_ = steady_s();
  }
  void seen() {
    longest_s_ = std::max(longest_s_, steady_s() - std::exchange(seen_s_, steady_s()));
  }
  /// Since restart(), with the time since the last word: perhaps none ever came.
  double longest_s() const { return std::max(longest_s_, steady_s() - seen_s_); }

 private:
  double seen_s_ = 0.0, longest_s_ = 0.0;
};

/// A server and one that stands by beside it, with three clients in this process.
class SecondServer : public ::testing::Test {
 public:
  static constexpr double kWatched_s = 1.5;

 protected:
  static constexpr double kStep_mm = 0.01, kEvery_s = 1.0 / 60.0;
  static constexpr int kClients = 3;

  std::unique_ptr<Program> lead() {
    return start({folder_.write("blocks.yaml", blocks_yaml()), "--log", logs()});
  }
  std::unique_ptr<Program> stand_by() {
    auto server = start({"--standby-of", "default", "--restore", logs(), "--log", logs()});
    EXPECT_TRUE(says(*server, "in step")) << server->errors();
    return server;
  }
  std::unique_ptr<Program> start(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--domain", std::to_string(domain_), "--json"});
    return std::make_unique<Program>(folder_.path(), "mortise-server", arguments);
  }
  std::string logs() const { return folder_.path().string() + "/logs"; }
  void SetUp() override { std::filesystem::create_directories(logs()); }

  /// anna presses red into the base and holds it there; ben's hand moves blue at 60 Hz; otto looks
  /// on.
  void come_in() {
    join("blue");
    if (HasFatalFailure()) return;
    ASSERT_TRUE(anna_->grab("red"));
    anna_->client->send(anna_->user, anna_->client->find_part("red"), {1, 0, -12});
    ASSERT_TRUE(anna_->until(kPatience_s, [&] { return !anna_->client->open_clashes().empty(); }));
  }
  /// All three; ben takes this part, which is called blue.
  void join(const char* bens_part) {
    anna_ = std::make_unique<Guest>(domain_, "anna");
    ben_ = std::make_unique<Guest>(domain_, "ben");
    otto_ = std::make_unique<Guest>(domain_, "otto", "observer");
    ASSERT_TRUE(anna_->joined());
    ASSERT_TRUE(ben_->joined());
    ASSERT_TRUE(otto_->joined());
    ASSERT_TRUE(ben_->grab(bens_part));
    blue_ = ben_->client->find_part(bens_part);
  }
  /// One that leads, its users, and one that stands by.
  std::pair<std::unique_ptr<Program>, std::unique_ptr<Program>> both() {
    std::unique_ptr<Program> first = lead();
    come_in();
    std::unique_ptr<Program> second = stand_by();
    return {std::move(first), std::move(second)};
  }
  /// Lets all act for a while; notes what came when.
  void turn(double seconds) {
    for (const double end_s = steady_s() + seconds; steady_s() < end_s;) {
      if (!ben_) return sleep_a_moment();
      const ClientUpdate of_anna = listen(*anna_, gaps_[0]), of_ben = listen(*ben_, gaps_[1]);
      listen(*otto_, gaps_[2]);
      if (of_ben.server_lost) in_doubt();
      told_of_drain_ |= of_anna.pulse && of_anna.pulse->draining;
      // What is refused is told before it is acknowledged, and is in no session.
      for (const RefusedIncrement& refused : of_ben.refused) sent_.erase(refused.seq);
      for (const SeenAck& ack : of_ben.acks) acknowledge(ack.seq);
      if (moves_ && steady_s() - sent_s_ >= kEvery_s) {
        sent_s_ = steady_s();
        if (const std::uint64_t seq = ben_->client->send(ben_->user, blue_, {0, kStep_mm, 0}))
          sent_.insert(seq);
      }
      sleep_a_moment();
    }
  }
  /// Lets all act until it is so.
  bool wait_until(const std::function<bool()>& done) {
    for (const double end_s = steady_s() + kPatience_s; !done(); turn(0.01))
      if (steady_s() > end_s) return false;
    return true;
  }
  bool says(Program& server, const std::string& words) {
    return wait_until([&] {
             return server.errors().find(words) != std::string::npos || !server.running();
           }) &&
           server.errors().find(words) != std::string::npos;
  }
  /// All three are in, wherever the session goes on.
  bool all_in() {
    return wait_until([&] {
      for (const Guest* guest : {anna_.get(), ben_.get(), otto_.get()})
        if (!guest->client->user_id(guest->user) || !guest->client->synced()) return false;
      return true;
    });
  }
  /// What another server has to go on with.
  struct AllIn {
    UserId anna, ben;
    std::map<ClashId, CollisionClass> clashes;
    int losses = 0;
  };
  AllIn as_all_are() const {
    return {anna_->client->user_id(0), ben_->client->user_id(0), clashes(*anna_), losses_};
  }
  void expect_all_as(const AllIn& before) {
    EXPECT_TRUE(all_in());
    EXPECT_EQ(losses_, before.losses + kClients) << "each client changes servers once";
    EXPECT_EQ(anna_->client->user_id(0), before.anna);
    EXPECT_EQ(ben_->client->user_id(0), before.ben);
    EXPECT_EQ(ben_->holder("blue"), before.ben) << "what was held is held";
    EXPECT_EQ(anna_->holder("red"), before.anna);
    EXPECT_EQ(clashes(*anna_), before.clashes);
    EXPECT_EQ(clashes(*ben_), before.clashes);
  }
  ClientUpdate listen(Guest& guest, PoseGap& gap) {
    ClientUpdate update = guest.listen();
    losses_ += update.server_lost;
    if (std::count(update.changed.begin(), update.changed.end(), blue_) > 0) gap.seen();
    return update;
  }
  static void sleep_a_moment() { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }
  void acknowledge(std::uint64_t seq) {
    acknowledged_.insert(sent_.begin(), sent_.upper_bound(seq));
    sent_.erase(sent_.begin(), sent_.upper_bound(seq));
  }
  /// What was sent to a server that is gone, and not acknowledged by it, may be lost.
  void in_doubt() { sent_.clear(); }
  static std::map<ClashId, CollisionClass> clashes(const Guest& guest) {
    std::map<ClashId, CollisionClass> all;
    for (const auto& [id, clash] : guest.client->open_clashes())
      all[id] = clash.verdict.collision_class;
    return all;
  }
  /// Longest time without a word of the moving part, from a kill until it goes on, as the client
  /// sees it that waits longest; where it does not go on, all the time for which is watched.
  double longest_gap_after(const std::function<void()>& act) {
    moves_ = true;
    turn(0.3);
    for (PoseGap& gap : gaps_) gap.restart();
    act();
    turn(kWatched_s);
    double longest_s = 0.0;
    for (const PoseGap& gap : gaps_) longest_s = std::max(longest_s, gap.longest_s());
    return longest_s;
  }
  /// Each server goes on in a file of its own; the name of the first sorts first.
  std::filesystem::path first_log() const {
    std::filesystem::path first;
    for (const auto& entry : std::filesystem::directory_iterator(logs()))
      if (entry.path().extension() == ".mcap" && (first.empty() || entry.path() < first))
        first = entry.path();
    return first;
  }
  /// Ends the session; what of the acknowledged is not in the log of the last server.
  std::size_t lost_of_acknowledged(Program& server) {
    moves_ = false;
    turn(0.3);
    server.signal(SIGTERM);
    EXPECT_EQ(server.wait(kPatience_s), 0) << server.errors();
    const std::filesystem::path first = first_log();
    if (first.empty()) return acknowledged_.size();
    const auto log = read_session(first);
    EXPECT_TRUE(log) << log.error().text;
    const auto verified = verify(*log, 1);
    EXPECT_TRUE(verified && !verified->difference && verified->not_verifiable.empty())
        << (verified && verified->difference ? verified->difference->what : "");
    std::set<std::uint64_t> lost = acknowledged_;
    for (const TickRecord& tick : log->ticks)
      for (const Increment& increment : tick.increments)
        if (increment.part == blue_) lost.erase(increment.seq);
    return lost.size();
  }

  const int domain_ = own_domain();
  TestFolder folder_;
  std::unique_ptr<Guest> anna_, ben_, otto_;
  PartId blue_;
  bool moves_ = false, told_of_drain_ = false;
  int losses_ = 0;
  double sent_s_ = 0.0;
  std::array<PoseGap, kClients> gaps_;
  std::set<std::uint64_t> sent_, acknowledged_;
};

}  // namespace mortise::test
