#pragma once
#include <gtest/gtest.h>
#include <signal.h>

#include <array>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/io/log/log_chain.h"
#include "common/io/log/replay.h"
#include "server/etcd_client.h"
#include "server/restore.h"
#include "tests/network/counter_history.h"
#include "tests/network/guest.h"
#include "tests/network/key_ring.h"
#include "tests/network/lossy_link.h"
#include "tests/network/program.h"
#include "tests/network/small_server.h"

namespace mortise::test {

/// Three hosts with a node of etcd and a designer each; servers on the first two. Each designer
/// counts up: a step of kStep_mm a beat, of a part of its own. Who leads, and who stands by,
/// changes with what happens; whatever ends is started again.
class EtcdSite : public ::testing::Test {
 protected:
  static constexpr int kSides = 3, kServers = 2, kDomain = 216;
  static constexpr double kStep_mm = 0.015625, kBeat_s = 1.0 / 60.0;
  static constexpr const char* kEtcd = "/usr/bin/etcd";

  void SetUp() override {
    if (!std::filesystem::exists(kEtcd)) GTEST_SKIP() << "program absent: etcd (etcd-server)";
    auto opened = LossyLink::open({.delay_s = 0.001, .seed = 5}, kSides);
    if (!opened) GTEST_SKIP() << "not root: no network namespaces: " << opened.error().text;
    link_ = std::move(*opened);
    for (const char* name : {"hall", "spare"}) keys_.issue(name, "server");
    for (const char* name : kUsers) keys_.issue(name, "designer");
    ASSERT_EQ(keys_.trouble(), "");
    logs_ = folder_.path().string() + "/logs";
    std::filesystem::create_directories(logs_);
    scenario_ = folder_.write("counters.yaml", counters_yaml());
    for (int side = 0; side < kSides; ++side) start_etcd(side);
    ASSERT_TRUE(until(
        kPatience_s, [this] { return word().has_value(); }, [] {}));
    start_server(0, {scenario_});
    ASSERT_TRUE(until(
        kPatience_s, [this] { return leads(0); }, [] {}))
        << errors();
    start_server(1, {"--standby-of", "default", "--restore", logs_});
    for (int side = 0; side < kSides; ++side)
      designers_.push_back(link_->on_side(side, [this, side] { count_up(side); }));
    ASSERT_TRUE(whole_again()) << errors();
  }
  void TearDown() override {
    stop_ = true;
    for (std::thread& designer : designers_) designer.join();
  }

  // What happens.
  /// The designer's program there ends, and is started again: another participant, under the same
  /// name, whose numbers begin anew. Where its host is cut off, nobody is told that it has gone.
  void come_anew(int side) { to_come_anew_[at(side)] = true; }
  void start_etcd(int side) {
    const std::string name = "n" + std::to_string(side);
    link_
        ->on_side(side,
                  [&] {
                    etcds_[at(side)] = std::make_unique<Program>(
                        folder_.path(), kEtcd,
                        std::vector<std::string>{
                            "--name",
                            name,
                            "--data-dir",
                            folder_.path().string() + "/" + name,
                            "--logger",
                            "zap",
                            "--log-level",
                            "error",
                            "--listen-peer-urls",
                            url(side, 2380),
                            "--initial-advertise-peer-urls",
                            url(side, 2380),
                            "--listen-client-urls",
                            url(side, 2379),
                            "--advertise-client-urls",
                            url(side, 2379),
                            "--initial-cluster",
                            "n0=" + url(0, 2380) + ",n1=" + url(1, 2380) + ",n2=" + url(2, 2380),
                            "--initial-cluster-state",
                            "new"});
                  })
        .join();
  }
  void start_server(int side, std::vector<std::string> words) {
    words.insert(words.end(), {"--log", logs_, "--domain", std::to_string(kDomain), "--interface",
                               LossyLink::address(side), "--peers", LossyLink::address(1 - side),
                               "--keys", keys_[side == 0 ? "hall" : "spare"], "--etcd", nodes()});
    link_
        ->on_side(side,
                  [&] {
                    servers_[at(side)] =
                        std::make_unique<Program>(folder_.path(), "mortise-server", words);
                  })
        .join();
    began_as_first_[at(side)] = words.front() == scenario_ || words.front() == "--restore";
  }
  /// What has ended stands by from now on; where nobody has led for long, it goes on with the log.
  void start_again() {
    for (int side = 0; side < kServers; ++side) {
      if (servers_[at(side)]->running()) continue;
      said_ += "-- " + std::to_string(side) + "\n" + servers_[at(side)]->errors() +
               servers_[at(side)]->out();
      start_server(side, {"--standby-of", "default", "--restore", logs_});
    }
  }

  // What is.
  bool said(int side, const std::string& words) const {
    return servers_[at(side)]->errors().find(words) != std::string::npos;
  }
  bool leads(int side) const {
    return servers_[at(side)]->running() &&
           said(side, began_as_first_[at(side)] ? "session 'default' of" : "taken over at tick");
  }
  int leader() const { return leads(0) && !leads(1) ? 0 : leads(1) && !leads(0) ? 1 : -1; }
  std::optional<std::string> word() {
    std::optional<EtcdClient::Value> value;
    link_->on_side(2, [&] { value = EtcdClient::open(nodes())->read("/mortise/default/word"); })
        .join();
    return value ? std::optional(value->text) : std::nullopt;
  }
  /// One leads, the other may take over, and all designers go on.
  bool whole_again() {
    const auto before = counts();
    return until(
        2.0 * kPatience_s,
        [&] {
          sleep_s(0.1);
          start_again();
          if (leader() < 0) return false;
          const auto now = word();
          if (!now || now->find('|') == std::string::npos || now->back() == '|') return false;
          const auto counted = counts();
          for (int side = 0; side < kSides; ++side)
            if (counted[at(side)] < before[at(side)] + 10) return false;
          return true;
        },
        [] {});
  }
  std::array<std::uint64_t, kSides> counts() const {
    const std::lock_guard lock(mutex_);
    std::array<std::uint64_t, kSides> counts{};
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = histories_[i].known().size();
    return counts;
  }
  std::string errors() const {
    std::string all = said_;
    for (int side = 0; side < kServers; ++side)
      if (servers_[at(side)])
        all += "-- " + std::to_string(side) + "\n" + servers_[at(side)]->errors();
    return all;
  }
  std::string what_is_wrong() const {
    const std::lock_guard lock(mutex_);
    for (const CounterHistory& history : histories_)
      if (std::string wrong = history.what_is_wrong(); !wrong.empty()) return wrong;
    return "";
  }
  /// Acknowledged increments that are not in the session, as the log of its last server has it, or
  /// are in it twice.
  std::size_t lost() {
    stop_ = true;
    for (std::thread& designer : designers_) designer.join();
    designers_.clear();
    for (auto& server : servers_) server->signal(SIGTERM);
    for (auto& server : servers_) EXPECT_GE(server->wait(kPatience_s), 0) << server->errors();
    const auto first = logs_to_restore(logs_, "default");
    const auto log = first.empty() ? Result<SessionLog>(fail(Code::kNotFound, "no log"))
                                   : read_session(first.back());
    if (!log) return ADD_FAILURE() << log.error().text, ~std::size_t{0};
    const auto verified = verify(*log, 1);
    EXPECT_TRUE(verified && !verified->difference);
    std::size_t lost = 0;
    for (int side = 0; side < kSides; ++side) {
      std::map<std::uint64_t, int> more;  ///< by seq: in the log, less what was acknowledged
      for (const TickRecord& tick : log->ticks)
        for (const Increment& increment : tick.increments)
          if (increment.user == users_[at(side)]) ++more[increment.seq];
      for (const auto& [seq, at_s] : histories_[at(side)].known()) lost += --more[seq & kSeqOf] < 0;
      // Numbers begin again with each coming; in each, one is taken once.
      for (const auto& [seq, count] : more) lost += count > came_[at(side)];
    }
    return lost;
  }

  int came_anew() const { return came_[0] + came_[1] + came_[2] - kSides; }
  static std::size_t at(int side) { return static_cast<std::size_t>(side); }
  static std::string url(int side, int port) {
    return "http://" + LossyLink::address(side) + ":" + std::to_string(port);
  }
  static std::string nodes() { return url(0, 2379) + "," + url(1, 2379) + "," + url(2, 2379); }

  TestFolder folder_;
  std::unique_ptr<LossyLink> link_;
  KeyRing keys_{"site"};
  std::string logs_, scenario_, said_;
  std::array<std::unique_ptr<Program>, kSides> etcds_;
  std::array<std::unique_ptr<Program>, kServers> servers_;

 private:
  static constexpr std::array<const char*, kSides> kUsers = {"anna", "ben", "cleo"};

  static std::string counters_yaml() {
    std::string yaml = "name: counters\nunits: mm\npolicy: report\nparts:\n";
    for (int i = 0; i < kSides; ++i)
      yaml += "  - {name: c" + std::to_string(i) +
              ", generator: {kind: block, x: 10, y: 10, z: 10}, moving: true, pose: {position: "
              "[0, " +
              std::to_string(60 * i) + ", 0]}}\n";
    return yaml;
  }
  void count_up(int side) {
    DdsOptions options;
    options.domain = kDomain;
    options.interface = LossyLink::address(side);
    options.server = LossyLink::address(0) + "," + LossyLink::address(1);
    options.keys = keys_[kUsers[at(side)]];
    auto guest = std::make_unique<Guest>(options, kUsers[at(side)]);
    const std::string name = "c" + std::to_string(side);
    CounterHistory& history = histories_[at(side)];
    std::set<std::uint64_t> sent;
    double next_s = now_s(), asked_s = 0.0, before_s = now_s(), in_s = now_s();
    while (!stop_) {
      sleep_s(0.004);
      // With keys, some are not let in again after a cut (Fast DDS 2.9.1): they come anew.
      if (to_come_anew_[at(side)].exchange(false) || now_s() - in_s > kComeAnew_s) {
        guest.reset();
        guest = std::make_unique<Guest>(options, kUsers[at(side)]);
        in_s = now_s();
        const std::lock_guard lock(mutex_);
        ++came_[at(side)];
        sent.clear();
      }
      const double begun_s = std::exchange(before_s, now_s());
      const ClientUpdate update = guest->listen();
      const std::lock_guard lock(mutex_);
      // May be taken or lost, and the client says so.
      for (const GivenUp& given_up : update.given_up)
        sent.erase(sent.begin(), sent.upper_bound(given_up.seq));
      for (const SeenAck& ack : update.acks)
        for (; !sent.empty() && *sent.begin() <= ack.seq; sent.erase(sent.begin()))
          history.acknowledged(*sent.begin() | coming(side), now_s());
      for (const RefusedIncrement& one : update.refused)
        if (one.reason != Refusal::kDuplicate) history.refused(one.seq | coming(side));
      const UserId user = guest->client->user_id(guest->user);
      const PartId part = guest->client->find_part(name);
      if (!user || !part || !guest->client->synced()) continue;
      in_s = now_s();
      users_[at(side)] = user;
      const KnownPart& known = guest->client->parts().at(part);
      if (!update.changed.empty() || update.resynced)
        // What a server said it said before it was heard, and after the last time we listened.
        history.read(begun_s, now_s(),
                     static_cast<std::uint64_t>(std::lround(known.info.X_WP.p.x() / kStep_mm)));
      if (known.info.holder != user) {
        if (now_s() - asked_s > 0.5) guest->client->grab(guest->user, part), asked_s = now_s();
        continue;
      }
      if (now_s() < next_s) continue;
      next_s = std::max(next_s + kBeat_s, now_s());  // who was out does not make up for it
      if (const std::uint64_t seq = guest->client->send(guest->user, part, {kStep_mm, 0, 0})) {
        history.asked(now_s());
        sent.insert(seq);
      }
    }
  }

  static constexpr double kComeAnew_s = 15.0;
  static constexpr std::uint64_t kSeqOf = 0xffffffff;
  std::uint64_t coming(int side) const { return static_cast<std::uint64_t>(came_[at(side)]) << 32; }

  std::array<bool, kServers> began_as_first_{};
  std::vector<std::thread> designers_;
  std::atomic<bool> stop_{false};
  std::array<std::atomic<bool>, kSides> to_come_anew_{};
  mutable std::mutex mutex_;
  std::array<CounterHistory, kSides> histories_;
  std::array<UserId, kSides> users_;
  std::array<int, kSides> came_{1, 1, 1};  ///< so often
};

}  // namespace mortise::test
