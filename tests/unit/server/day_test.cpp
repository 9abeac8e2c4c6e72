// A day of a session in the time that its work takes: people come, work, fall silent, are killed
// and go, and nothing that the session holds grows with the hours. MORTISE_DAY_S says how much of
// it: ten minutes unless told, 24 hours in a soak. No network: the channel is one of memory.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>
#include <thread>

#include "client/client.h"
#include "common/io/log/log_chain.h"
#include "common/io/log/replay.h"
#include "common/io/log/session_log.h"
#include "common/io/scenario/scenario_file.h"
#include "common/io/state/checkpoint.h"
#include "common/messages/memory_channel.h"
#include "server/tick_loop.h"
#include "tests/support/effort.h"
#include "tests/support/growth.h"
#include "tests/support/small_scenarios.h"
#include "tests/support/test_folder.h"

namespace mortise {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr char kScenario[] = "day.yaml";
constexpr int kPeople = 6, kTicks_per_s = 60;
constexpr std::uint32_t kNames = 8;                  ///< that the session remembers
constexpr double kBurst_s = 20.0, kEvery_s = 200.0;  ///< they work for so long, so often
constexpr double kState_kb = 64.0, kGrowth_mb = 4.0;

struct DayClock final : Clock {
  std::int64_t at_ns = 100 * kSecond_ns;
  std::int64_t now_ns() override { return at_ns; }
  std::int64_t wall_ns() override { return at_ns; }
  void sleep_until_ns(std::int64_t deadline_ns) override { at_ns = std::max(at_ns, deadline_ns); }
};

struct Counts {
  int joins = 0, leaves = 0, kills = 0, silences = 0, moves = 0, commands = 0, names = 0;
};

/// One of the people, who comes again and again: now by the same name, now by one never heard
/// before.
class Person {
 public:
  Person(MemoryHub& hub, DayClock& clock, int number)
      : hub_(hub), clock_(clock), random_(static_cast<unsigned>(number)) {
    name_ = std::string(1, static_cast<char>('a' + number));
  }
  void turn(bool works, Counts& counts) {
    if (client_ == nullptr) {
      if (works && chance(0.02)) come(counts);
      return;
    }
    if (silent_until_ns_ > clock_.at_ns) return;  // present, and says nothing
    client_->poll();
    if (works && client_->user_id(0)) return work(counts);
    if (!works && chance(0.02)) go(counts);
  }

 private:
  bool chance(double p) { return std::bernoulli_distribution(p)(random_); }
  void come(Counts& counts) {
    channel_ = hub_.open_client();
    key_ = hub_.last_client();
    client_ = std::make_unique<Client>(*channel_, ClientOptions{}, [this] { return clock_.at_ns; });
    const bool by_new_name = chance(0.5);
    counts.names += by_new_name;
    client_->add_user(by_new_name ? name_ + std::to_string(counts.names) : name_, "designer");
    ++counts.joins;
  }
  void go(Counts& counts) {
    if (chance(0.5)) {
      hub_.kill(key_);
      ++counts.kills;
    } else {
      client_->leave(0);
      ++counts.leaves;
    }
    client_.reset();
    channel_.reset();
  }
  void work(Counts& counts) {
    const PartId part = client_->find_part(chance(0.5) ? "red" : "blue");
    const auto known = client_->parts().find(part);
    if (known == client_->parts().end()) return;
    const PartInfo& info = known->second.info;
    if (info.holder != client_->user_id(0)) {
      if (chance(0.05)) counts.commands += client_->grab(0, part) != 0;
      return;
    }
    // To the plate and into it, as far as it lets them, and away again.
    const Vec3 away = info.X_WP.p;
    std::normal_distribution<double> wish(0.0, 1.0);
    const Vec3 by = Vec3(wish(random_), wish(random_), wish(random_)) - 0.02 * away;
    counts.moves += client_->send(0, part, by) != 0;
    if (chance(0.01)) counts.commands += client_->undo(0, part) != 0;
    if (chance(0.005)) counts.commands += client_->reset(0, part) != 0;
    if (chance(0.01)) counts.commands += client_->release(0, part) != 0;
    if (chance(0.01) && !client_->open_clashes().empty()) {
      const ClashId clash = client_->open_clashes().begin()->first;
      counts.commands += client_->review(0, clash, ReviewStatus::kReviewed, "seen") != 0;
    }
    if (chance(0.002)) {
      silent_until_ns_ = clock_.at_ns + 5 * kSecond_ns;  // longer than a lease
      ++counts.silences;
    } else if (chance(0.002)) {
      go(counts);
    }
  }

  MemoryHub& hub_;
  DayClock& clock_;
  std::mt19937 random_;
  std::string name_;
  ClientKey key_;
  std::unique_ptr<ClientChannel> channel_;
  std::unique_ptr<Client> client_;
  std::int64_t silent_until_ns_ = 0;
};

/// What has become too old is taken away, as an operator does.
void keep_newest(const std::filesystem::path& folder, std::size_t files) {
  std::vector<std::filesystem::path> all;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) all.push_back(entry.path());
  std::sort(all.begin(), all.end());
  for (std::size_t i = 0; i + files < all.size(); ++i) std::filesystem::remove(all[i]);
}

LoadedScene blocks_scene(const std::string& yaml) {
  const auto reading = read_scenario_text(yaml, kScenario);
  EXPECT_TRUE(reading && reading->usable());
  auto scene = load_scene(reading->scenario, default_meshes());
  EXPECT_TRUE(scene && scene->usable());
  return std::move(*scene);
}

std::unique_ptr<SessionLogWriter> log_in(const std::filesystem::path& folder,
                                         const std::string& yaml, const LoadedScene& scene) {
  LogOptions options;
  options.rotate_bytes = 2'000'000;
  auto writer = SessionLogWriter::create(folder / "day.mcap",
                                         log_header(scene, "day", kScenario, yaml), options);
  EXPECT_TRUE(writer) << writer.error().text;
  return writer ? std::move(*writer) : nullptr;
}

/// The last hours of the session as they are on disk, computed again.
void expect_log_verifies(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  const auto log = read_session(files);
  ASSERT_TRUE(log) << log.error().text;
  EXPECT_TRUE(log->complete);
  EXPECT_TRUE(log->gaps.empty());
  const auto verified = verify(*log, 1);
  ASSERT_TRUE(verified) << verified.error().text;
  EXPECT_FALSE(verified->difference) << verified->difference->what;
  EXPECT_EQ(verified->not_verifiable, "");
  EXPECT_EQ(verified->ticks_compared, verified->ticks_logged);
  std::printf("%zu files left: %llu ticks and %llu checkpoints computed again, all the same\n",
              files.size(), static_cast<unsigned long long>(verified->ticks_compared),
              static_cast<unsigned long long>(verified->checkpoints_compared));
}

double day_s() {
  const char* seconds = std::getenv("MORTISE_DAY_S");
  return seconds != nullptr ? std::atof(seconds) : test::timed() ? 86400.0 : 600.0;
}

TEST(Day, NothingThatASessionHoldsGrowsWithTheHours) {
  const double lasts_s = day_s();
  const auto begun = std::chrono::steady_clock::now();
  test::TestFolder folder;
  const std::string yaml = test::blocks_yaml({.head = "policy: stop\nlease_s: 2\n"});
  LoadedScene scene = blocks_scene(yaml);
  World& world = scene.world;
  MemoryHub hub;
  DayClock clock;
  const auto server = hub.open_server();
  const auto log = log_in(folder.path(), yaml, scene);
  ASSERT_NE(log, nullptr);
  TickLoopOptions options;
  options.inbox.max_users = options.inbox.names_kept = kNames;
  TickLoop loop(world, *server, clock, log.get(), options);
  loop.open();
  std::vector<Person> people;
  for (int i = 0; i < kPeople; ++i) people.emplace_back(hub, clock, i);

  Counts counts;
  std::vector<test::Holdings> seen;
  double most_state_kb = 0.0;
  const auto ticks = static_cast<std::int64_t>(lasts_s * kTicks_per_s);
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    const double now_s = static_cast<double>(tick) / kTicks_per_s;
    clock.at_ns += kSecond_ns / kTicks_per_s;
    const bool works = std::fmod(now_s, kEvery_s) < kBurst_s;
    for (Person& person : people) person.turn(works, counts);
    loop.tick();
    while (log->queued_ticks() > 1000) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (tick % (ticks / 100) != 0) continue;
    keep_newest(folder.path(), 3);
    seen.push_back(test::holdings_of(getpid(), now_s));
    most_state_kb =
        std::max(most_state_kb, static_cast<double>(encode_state(world).size()) / 1024.0);
    if (tick % (ticks / 10) == 0)
      std::printf("%5.1f h: %.2f MB, %d threads, %d handles, state %.1f kB\n", now_s / 3600.0,
                  seen.back().resident_mb, seen.back().threads, seen.back().handles,
                  static_cast<double>(encode_state(world).size()) / 1024.0);
  }
  EXPECT_EQ(log->dropped_ticks(), 0u);
  EXPECT_TRUE(log->close());
  expect_log_verifies(folder.path());
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  const double half_s = 0.5 * lasts_s, slope = test::resident_mb_per_h(seen, half_s);
  std::printf(
      "%.1f h in %.0f s: %d came (%d by new names), %d went, %d killed, %d silent for longer than "
      "a lease (%llu "
      "leases ended), %d moves, %d commands, %llu clash events; state at most %.1f kB; %+.3f MB an "
      "hour in the second half\n",
      lasts_s / 3600.0, took.count(), counts.joins, counts.names, counts.leaves, counts.kills,
      counts.silences, static_cast<unsigned long long>(loop.inbox().counters().lease_ends),
      counts.moves, counts.commands, static_cast<unsigned long long>(snapshot_of(world).event_seq),
      most_state_kb, slope);
  EXPECT_GT(counts.joins, kPeople);
  EXPECT_GT(counts.kills, 0);
  EXPECT_GT(counts.silences, 0);
  EXPECT_GT(loop.inbox().counters().accepted, 1000u);
  EXPECT_GT(loop.inbox().counters().lease_ends, 0u);

  EXPECT_GT(counts.names, static_cast<int>(kNames)) << "no id was taken over";
  EXPECT_LE(world.users.size(), std::size_t{kNames}) << "names that nobody comes by any more";
  EXPECT_EQ(loop.inbox().waiting_commands() + loop.inbox().waiting_increments(), 0u);
  EXPECT_LE(most_state_kb, kState_kb);
  const auto later = [&](auto what) {
    return test::most(seen, what, half_s, lasts_s) - test::most(seen, what, 0.0, half_s);
  };
  EXPECT_LE(later(&test::Holdings::threads), 0);
  EXPECT_LE(later(&test::Holdings::handles), 1) << "the next file of the log is being begun";
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  // A sanitizer keeps freed memory for a while, and says itself what leaks.
  EXPECT_LE(later(&test::Holdings::resident_mb), kGrowth_mb);
#endif
}

}  // namespace
}  // namespace mortise
