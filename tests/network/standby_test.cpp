// A second server beside the first: what clients see when the first is killed, again and again.
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "common/base/hash.h"
#include "tests/network/second_server.h"
#include "tests/network/stalls.h"
#include "tests/network/stopped_thread.h"
#include "tests/support/cube_file.h"
#include "tests/support/effort.h"

namespace mortise::test {
namespace {

constexpr double kTakeOver_s = 0.25;  // as every client sees it
constexpr double kHangs_s = 2.0;      // where the first lives, and its ticks do not go on
constexpr double kComesBack_s = 1.2;  // whatever the machine does
static_assert(kComesBack_s < SecondServer::kWatched_s);
// A machine that stands still for so long tells nothing of the time: that kill is made once more.
constexpr double kStall_s = 0.05;
constexpr int kMostStalledKills = 4;

using Standby = SecondServer;

/// Takes the processors from a program: it runs at the lowest priority, among many that are busy.
class BusyThreads {
 public:
  explicit BusyThreads(const Program& starved) {
    const std::string threads = "/proc/" + std::to_string(starved.pid()) + "/task";
    for (const auto& thread : std::filesystem::directory_iterator(threads)) {
      const sched_param least{};
      sched_setscheduler(std::stoi(thread.path().filename()), SCHED_IDLE, &least);
    }
    for (unsigned i = 0; i < 4 * std::thread::hardware_concurrency(); ++i)
      busy_.emplace_back([this] {
        while (!stop_) std::atomic_signal_fence(std::memory_order_seq_cst);
      });
  }
  ~BusyThreads() {
    stop_ = true;
    for (std::thread& thread : busy_) thread.join();
  }
  BusyThreads(const BusyThreads&) = delete;
  BusyThreads& operator=(const BusyThreads&) = delete;

 private:
  std::atomic<bool> stop_{false};
  std::vector<std::thread> busy_;
};

TEST_F(Standby, TakesOverFromEachThatIsKilled) {
  const int kills = timed() ? 20 : 1;
  std::unique_ptr<Program> leader = lead();
  come_in();
  AllIn before = as_all_are();
  ASSERT_EQ(before.clashes.size(), 1u);
  std::vector<double> gaps_s;
  for (int tries = 0; static_cast<int>(gaps_s.size()) < kills; ++tries) {
    ASSERT_LT(tries, kills + kMostStalledKills) << "the machine stands still too often";
    std::unique_ptr<Program> second = stand_by();
    ASSERT_FALSE(HasFailure());
    before.losses = losses_;
    std::optional<Stalls> stalls;
    const double gap_s = longest_gap_after([&] {
      stalls.emplace();
      leader->signal(SIGKILL);
    });
    const double stall_s = stalls->longest_s(gap_s);
    if (stall_s < kStall_s || !timed()) {
      gaps_s.push_back(gap_s);
      std::printf("take-over %zu: %.0f ms\n", gaps_s.size(), gap_s * 1e3);
    } else {
      std::printf("not counted: the machine itself stood still for %.0f ms, take-over %.0f ms\n",
                  stall_s * 1e3, gap_s * 1e3);
    }
    EXPECT_TRUE(says(*second, "taken over at tick")) << second->errors();
    expect_all_as(before);
    leader = std::move(second);
  }
  EXPECT_GT(acknowledged_.size(), 30u);
  EXPECT_EQ(lost_of_acknowledged(*leader), 0u);
  std::sort(gaps_s.begin(), gaps_s.end());
  std::printf(
      "take-over as every client sees it, %d kills: %.0f ms at least, %.0f median, %.0f most\n",
      kills, gaps_s.front() * 1e3, gaps_s[gaps_s.size() / 2] * 1e3, gaps_s.back() * 1e3);
  if (timed()) {
    EXPECT_LE(gaps_s.back(), kTakeOver_s);
  }
}

/// A part that came while both ran is there after the take-over, and in the log of the second.
TEST_F(Standby, KnowsThePartsThatWereAdded) {
  auto [leader, second] = both();
  const std::vector<std::byte> file = cube_file(3.0);
  ASSERT_NE(anna_->client->upload(anna_->user, "post.stl", 1.0, file), 0u);
  ASSERT_NE(anna_->client->add_part(anna_->user, "post", content_hash(file),
                                    Pose::translation({0, 0, 200}), true),
            0u);
  const auto all_see = [&] {
    return wait_until([&] {
      for (const Guest* guest : {anna_.get(), ben_.get(), otto_.get()})
        if (!guest->client->find_part("post")) return false;
      return true;
    });
  };
  ASSERT_TRUE(all_see()) << leader->errors();
  const PartId post = ben_->client->find_part("post");
  leader->signal(SIGKILL);
  EXPECT_TRUE(says(*second, "taken over at tick")) << second->errors();
  EXPECT_TRUE(all_in());
  EXPECT_TRUE(all_see());
  EXPECT_EQ(ben_->client->find_part("post"), post);
  EXPECT_TRUE(anna_->grab("post"));
  second->signal(SIGINT);
  EXPECT_EQ(second->wait(kPatience_s), 0) << second->errors();
  const auto restored = logs_to_restore(logs(), "default", Newest::kWritten);
  ASSERT_FALSE(restored.empty());
  const auto log = read_session(restored.front());
  ASSERT_TRUE(log) << log.error().text;
  const auto report = verify(*log, 1);
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_FALSE(report->difference) << report->difference->what;
  EXPECT_TRUE(std::ranges::any_of(log->ticks, [](const TickRecord& tick) {
    return std::ranges::any_of(tick.decisions, [](const Decision& decision) {
      return decision.kind == Decision::Kind::kAddPart;
    });
  }));
  // And a session that goes on from that log has it.
  const std::unique_ptr<Program> third = start({"--restore", logs(), "--no-log"});
  EXPECT_TRUE(all_in());
  EXPECT_TRUE(all_see()) << third->errors();
}

/// Ticks that take long: what is told and not computed yet is computed before the second leads.
TEST_F(Standby, TakesOverUnderHandsThatPushTheGearbox) {
  const auto scenario = std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios" / "gearbox.yaml";
  const std::unique_ptr<Program> first = start({scenario.string(), "--log", logs()});
  join("screw_4");
  ASSERT_FALSE(HasFailure()) << first->errors();
  const Program bots(folder_.path(), "mortise-bot",
                     {"--domain", std::to_string(domain_), "--wait", "20", "--users", "6",
                      "--behaviour", "mixed", "--duration", "60"});
  const std::unique_ptr<Program> second = stand_by();
  ASSERT_FALSE(HasFailure());
  moves_ = true;
  turn(4.0);
  const std::size_t acknowledged = acknowledged_.size();
  const double gap_s = longest_gap_after([&] { first->signal(SIGKILL); });
  std::printf("take-over under six who push the gearbox: %.0f ms\n", gap_s * 1e3);
  if (timed()) {
    EXPECT_LT(gap_s, kComesBack_s);
  }
  EXPECT_TRUE(says(*second, "taken over at tick")) << second->errors();
  EXPECT_TRUE(all_in());
  EXPECT_TRUE(wait_until([&] { return acknowledged_.size() > acknowledged + 30; }));
  EXPECT_EQ(ben_->holder("screw_4"), ben_->client->user_id(0));
  EXPECT_GT(acknowledged, 60u);
  EXPECT_EQ(lost_of_acknowledged(*second), 0u);
  const auto closing = nlohmann::json::parse(second->out(), nullptr, false);
  ASSERT_TRUE(closing.is_object()) << second->out();
  EXPECT_FALSE(closing["standby"]["in_step"]) << "nobody stands by any more";
}

/// The gearbox half put together, as its play has it: clearance, transition, and a screw in a wall.
TEST_F(Standby, TheGearboxHasTheSameClashesAfterAsBefore) {
  const auto scenario = std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios" / "gearbox.yaml";
  const std::string play = folder_.write("half.play.yaml", R"(
acts:
  - {user: ann, part: input_shaft, release: false,
     steps: [{by: [0, 110, 0], seconds: 0.6}, {by: [0, 0, -80], seconds: 1}]}
  - {user: bob, part: output_shaft,
     steps: [{by: [0, 110, 0], seconds: 0.6}, {by: [0, 0, -80], seconds: 1}]}
  - {user: bob, part: gear_out, release: false,
     steps: [{by: [0, -160, 0], seconds: 0.8}, {by: [0, 0, -82.9], seconds: 1.2}]}
  - {user: dee, part: screw_1, release: false,
     steps: [{by: [0, 0, -90], seconds: 0.8}, {by: [0, 90, 0], seconds: 1}]}
)");
  const std::unique_ptr<Program> first = start({scenario.string(), "--log", logs()});
  join("screw_4");
  ASSERT_FALSE(HasFailure()) << first->errors();
  const Program bots(folder_.path(), "mortise-bot",
                     {"--domain", std::to_string(domain_), "--wait", "20", "--names", "ann,bob,dee",
                      "--behaviour", "script", "--play", play, "--linger", "60"});
  const std::unique_ptr<Program> second = stand_by();
  ASSERT_FALSE(HasFailure());
  const auto all_classes = [&] {
    std::set<CollisionClass> classes;
    for (const auto& [id, collision_class] : clashes(*otto_)) classes.insert(collision_class);
    return classes ==
           std::set{CollisionClass::kFake, CollisionClass::kPotential, CollisionClass::kReal};
  };
  for (const double end_s = steady_s() + 30.0; steady_s() < end_s && !all_classes();) turn(0.01);
  ASSERT_TRUE(all_classes()) << first->errors();
  turn(2.0);  // the last of them go in
  const auto before = clashes(*otto_);
  EXPECT_GE(before.size(), 4u);
  const double gap_s = longest_gap_after([&] { first->signal(SIGKILL); });
  std::printf("take-over of the gearbox with %zu clashes: %.0f ms\n", before.size(), gap_s * 1e3);
  EXPECT_TRUE(says(*second, "taken over at tick")) << second->errors();
  EXPECT_TRUE(all_in());
  for (const Guest* guest : {anna_.get(), ben_.get(), otto_.get()})
    EXPECT_EQ(clashes(*guest), before);
  EXPECT_EQ(lost_of_acknowledged(*second), 0u);
}

/// What holds take-overs to their time sees it where nothing comes back.
TEST_F(Standby, SoakWhereNobodyTakesOverTheGapIsAllTheTimeThatIsWatched) {
  const std::unique_ptr<Program> alone = lead();
  come_in();
  ASSERT_FALSE(HasFailure()) << alone->errors();
  EXPECT_GT(longest_gap_after([&] { alone->signal(SIGKILL); }), kComesBack_s);
}

TEST_F(Standby, OneThatIsThereFirstWaitsForTheOneThatLeads) {
  auto second = start({"--standby-of", "default", "--restore", logs(), "--log", logs()});
  ASSERT_TRUE(says(*second, "waiting for the server")) << second->errors();
  turn(0.5);  // its ports are taken by now
  const std::unique_ptr<Program> first = lead();
  come_in();
  ASSERT_FALSE(HasFailure()) << first->errors();
  ASSERT_TRUE(says(*second, "in step")) << second->errors();
  first->signal(SIGKILL);
  EXPECT_TRUE(says(*second, "taken over at tick")) << second->errors();
  EXPECT_TRUE(all_in());
  EXPECT_EQ(ben_->holder("blue"), ben_->client->user_id(0));
}

TEST_F(Standby, OneThatComesBackDoesNotFight) {
  auto [first, second] = both();
  ASSERT_FALSE(HasFailure());
  (void)longest_gap_after([&] { first->signal(SIGSTOP); });  // frozen, not dead
  ASSERT_TRUE(says(*second, "taken over at tick")) << second->errors();
  ASSERT_TRUE(all_in());
  const int losses = losses_;
  const double y = ben_->client->parts().at(blue_).info.X_WP.p.y();
  first->signal(SIGCONT);
  turn(3.0);
  EXPECT_EQ(first->wait(kPatience_s), 1);
  EXPECT_NE(first->errors().find("another server leads session 'default' since"), std::string::npos)
      << first->errors();
  EXPECT_EQ(losses_, losses) << "nobody has changed servers";
  EXPECT_TRUE(wait_until([&] { return ben_->client->parts().at(blue_).info.X_WP.p.y() > y + 1.0; }))
      << "the hand goes on";
  // And one that is started as if nothing had been.
  std::unique_ptr<Program> again = lead();
  turn(3.0);
  EXPECT_EQ(again->wait(kPatience_s), 1);
  EXPECT_NE(again->errors().find("another server leads session 'default'; start this one with"),
            std::string::npos)
      << again->errors();
  EXPECT_EQ(losses_, losses);
  EXPECT_EQ(lost_of_acknowledged(*second), 0u);
}

/// Only the thread that ticks stands still: all others go on and say that the server is there.
TEST_F(Standby, TakesOverWhereTheTicksOfTheFirstHang) {
  auto [first, second] = both();
  ASSERT_FALSE(HasFailure());
  const UserId ben = ben_->client->user_id(0);
  StoppedThread main_thread(first->pid());
  if (!main_thread.held()) GTEST_SKIP() << "not root: ptrace of another process";
  const double begun_s = steady_s();
  const auto comes_back = [&] {
    return second->errors().find("taken over at tick") != std::string::npos;
  };
  moves_ = true;
  ASSERT_TRUE(wait_until(comes_back)) << first->errors();
  const double taken_s = steady_s() - begun_s;
  ASSERT_TRUE(all_in());
  const std::size_t acknowledged = acknowledged_.size();
  EXPECT_TRUE(wait_until([&] { return acknowledged_.size() > acknowledged; }));
  std::printf("ticks of the first hang: taken over after %.0f ms, users go on after %.0f ms\n",
              taken_s * 1e3, (steady_s() - begun_s) * 1e3);
  if (timed()) {
    EXPECT_LT(steady_s() - begun_s, kHangs_s);
  }
  EXPECT_EQ(ben_->holder("blue"), ben);
  const int losses = losses_;
  turn(1.0);
  main_thread.release();
  turn(3.0);
  EXPECT_EQ(first->wait(kPatience_s), 1) << "no two lead";
  EXPECT_NE(first->errors().find("another server leads session 'default' since"), std::string::npos)
      << first->errors();
  EXPECT_EQ(losses_, losses) << "nobody has changed servers";
  EXPECT_GT(acknowledged_.size(), 30u);
  EXPECT_EQ(lost_of_acknowledged(*second), 0u);
}

/// Frozen for a little longer than the lease and woken before the second has opened its topics, or
/// after: what it says then must not be taken by anybody, or be with the second as well.
TEST_F(Standby, OneThatIsFrozenForAMomentAcknowledgesNothingThatIsLost) {
  std::unique_ptr<Program> first = lead();
  come_in();
  const std::vector<int> all_ms =
      timed() ? std::vector{150, 160, 170, 180, 250} : std::vector{165, 250};
  for (const int frozen_ms : all_ms) {
    std::unique_ptr<Program> second = stand_by();
    ASSERT_FALSE(HasFailure());
    (void)longest_gap_after([&] {
      first->signal(SIGSTOP);
      turn(frozen_ms * 1e-3);
      first->signal(SIGCONT);
    });
    turn(1.0);
    const bool taken_over = second->errors().find("taken over at tick") != std::string::npos;
    std::printf("frozen for %d ms: %s\n", frozen_ms, taken_over ? "taken over" : "went on");
    if (taken_over) {
      EXPECT_EQ(first->wait(kPatience_s), 1) << first->errors();
      first = std::move(second);
    } else {
      second->signal(SIGTERM);
      EXPECT_EQ(second->wait(kPatience_s), 0);
    }
    ASSERT_EQ(ben_->holder("blue"), ben_->client->user_id(0));
  }
  EXPECT_GT(acknowledged_.size(), 30u);
  EXPECT_EQ(lost_of_acknowledged(*first), 0u);
}

TEST_F(Standby, SoakAFirstWithoutAProcessorLosesNothingThatItAcknowledged) {
  auto [first, second] = both();
  ASSERT_FALSE(HasFailure());
  moves_ = true;
  {
    BusyThreads crowd(*first);
    turn(6.0);
  }
  turn(3.0);
  const bool taken_over = second->errors().find("taken over at tick") != std::string::npos;
  std::printf("starved for 6 s: %s, %zu acknowledged\n", taken_over ? "taken over" : "went on",
              acknowledged_.size());
  first->signal(SIGKILL);  // also where it went on
  turn(1.5);
  EXPECT_GT(acknowledged_.size(), 30u);
  EXPECT_EQ(lost_of_acknowledged(*second), 0u);
}

/// The silence that it then wants is as much longer as it was frozen, not a second.
TEST_F(Standby, OneThatIsFrozenAsItShouldTakeOverDoesSoSoonAfter) {
  const double kFrozen_s = 0.25;
  auto [first, second] = both();
  ASSERT_FALSE(HasFailure());
  std::jthread freeze;
  std::optional<Stalls> stalls;
  const double gap_s = longest_gap_after([&] {
    stalls.emplace();
    first->signal(SIGKILL);
    freeze = std::jthread([pid = second->pid(), kFrozen_s] {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      kill(pid, SIGSTOP);
      std::this_thread::sleep_for(std::chrono::duration<double>(kFrozen_s));
      kill(pid, SIGCONT);
    });
  });
  std::printf("frozen for %.0f ms as it should take over: %.0f ms as a client sees it\n",
              kFrozen_s * 1e3, gap_s * 1e3);
  EXPECT_TRUE(says(*second, "taken over at tick")) << second->errors();
  EXPECT_GT(gap_s, kFrozen_s);
  if (timed() && stalls->longest_s(gap_s) < kStall_s) {
    EXPECT_LT(gap_s, 1.0) << "a second of silence was wanted";
  }
  EXPECT_EQ(lost_of_acknowledged(*second), 0u);
}

TEST_F(Standby, OneThatStandsByAndIsFrozenDoesNotStopTheSession) {
  auto [first, second] = both();
  ASSERT_FALSE(HasFailure());
  const int losses = losses_;
  const double gap_s = longest_gap_after([&] { second->signal(SIGSTOP); });
  std::printf("a frozen standby keeps clients waiting once, for %.0f ms\n", gap_s * 1e3);
  EXPECT_TRUE(says(*first, "is silent: it is not waited for any more")) << first->errors();
  EXPECT_GT(gap_s, 0.3) << "it was not waited for";
  if (timed()) {
    EXPECT_LT(gap_s, 1.0);
  }
  second->signal(SIGCONT);  // after 1.5 s
  turn(3.0);
  EXPECT_EQ(second->errors().find("taken over at tick"), std::string::npos) << second->errors();
  EXPECT_EQ(losses_, losses) << "nobody has changed servers";
  first->signal(SIGKILL);  // and it is in step again
  EXPECT_TRUE(says(*second, "taken over at tick")) << second->errors();
  EXPECT_EQ(lost_of_acknowledged(*second), 0u);
}

TEST_F(Standby, OneThatWasFrozenForLongEndsAndDoesNotTakeOver) {
  auto [first, second] = both();
  ASSERT_FALSE(HasFailure());
  const int losses = losses_;
  (void)longest_gap_after([&] { second->signal(SIGSTOP); });
  turn(3.0);
  second->signal(SIGCONT);
  turn(1.0);
  EXPECT_EQ(second->wait(kPatience_s), 1);
  EXPECT_NE(second->errors().find("were not told to this one: start it again"), std::string::npos)
      << second->errors();
  EXPECT_EQ(losses_, losses) << "nobody has changed servers";
  second = stand_by();
  first->signal(SIGKILL);
  EXPECT_TRUE(says(*second, "taken over at tick")) << second->errors();
  EXPECT_TRUE(all_in());
  EXPECT_EQ(lost_of_acknowledged(*second), 0u);
}

}  // namespace
}  // namespace mortise::test
