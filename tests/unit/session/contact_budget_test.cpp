// What a tick may spend on first contact: who has none is told as not examined and goes no farther
// than it is proven clear, and gets there later.
#include "common/session/tick/contact_budget.h"
#include "common/ccd/distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <vector>

#include "tests/support/shapes.h"
#include "tests/unit/session/report_digest.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

constexpr double kGap_mm = 1e-3;

// Balls, each in a hollow of its own that is larger by a hair: there first contact is dear, 11,000
// tests for each of them.
struct Sockets {
  SessionBuilder session;
  Scratch scratch;
  UserId ada;
  std::vector<PartId> balls;
  std::uint64_t tests = 0, unanswered = 0;  ///< in the last tick
  std::uint64_t waiting = 0, not_examined = 0;

  Sockets(Policy policy, int wanted, double rate_hz, bool budget, int threads = 1)
      : session(policy), scratch(threads) {
    session.world.tick_rate_hz = rate_hz;
    ada = session.join("ada");
    const TriangleMesh ball = shapes::sphere(3.0, Vec3::Zero(), 24);
    TriangleMesh hollow = shapes::sphere(3.0 + kGap_mm, Vec3::Zero(), 24);
    for (auto& triangle : hollow.triangles) std::swap(triangle[1], triangle[2]);
    const TriangleMesh wall = shapes::together(shapes::sphere(6.0, Vec3::Zero(), 8), hollow);
    for (int i = 0; i < wanted; ++i) {
      session.add("socket", wall, at(0, 20.0 * i, 0), false);
      balls.push_back(session.add("ball", ball, at(0, 20.0 * i, 0), true));
      session.grab(ada, balls.back());
    }
    scratch.impl().switches.work_budget = budget;
    play_tick(session.world, {}, scratch);
  }
  StepReport push(const Vec3& by) {
    std::vector<Increment> increments;
    for (const PartId ball : balls) increments.push_back(session.push(ada, ball, by));
    const StepReport report = play_tick(session.world, increments, scratch);
    tests = unanswered = 0;
    const Scratch::Impl& work = scratch.impl();
    for (std::size_t i = 0; i < work.pair_count; ++i) {
      tests += work.pairs[i].effort.contact_tests;
      unanswered +=
          work.pairs[i].effort.contact_waits || work.pairs[i].effort.contact_short ? 1U : 0U;
    }
    waiting += report.counters.pairs_waiting;
    not_examined += report.counters.not_examined;
    return report;
  }
  bool any_crossing() {
    CcdScratch ccd;
    const auto& parts = session.world.parts;
    for (std::size_t i = 0; i + 1 < parts.size(); i += 2)
      if (surfaces_cross(*parts[i].solid, parts[i].X_WP, *parts[i + 1].solid, parts[i + 1].X_WP,
                         ccd))
        return true;
    return false;
  }
  double moved_mm(const ClashEvent& event) {
    for (std::size_t i = 0; i < balls.size(); ++i)
      if (event.part_a == balls[i] || event.part_b == balls[i]) return moved_mm(i);
    return 0.0;
  }
  double moved_mm(std::size_t i) {
    const Part& ball = *session.world.find(balls[i]);
    return (ball.X_WP.p - ball.X_WP_scenario.p).norm();
  }
};

TEST(ContactBudget, ATickSpendsNoMoreThanItMayAndSaysWhatItLeftOut) {
  Sockets with(Policy::kStop, 24, 1000.0, true), without(Policy::kStop, 24, 1000.0, false);
  const Vec3 by(0.3 * kGap_mm, 0, 0);
  without.push(by);
  ASSERT_GT(without.tests, 200'000U) << "not dear: nothing is shown";
  EXPECT_EQ(without.not_examined, 0U);
  std::uint64_t all = 0;
  for (int i = 0; i < 50; ++i) {
    const StepReport report = with.push(by);
    all += with.tests;
    // What was saved when the session began, and the last two, which may take more than is left.
    EXPECT_LT(with.tests, 3U * 2'000U + 2U * 22'000U);
    EXPECT_GT(report.counters.not_examined, 0U);
    EXPECT_GE(report.counters.not_examined, report.counters.pairs_waiting);
    for (const ClashEvent& event : report.events)
      EXPECT_GT(with.moved_mm(event), 0.9 * kGap_mm) << "who had no work has met nothing";
    ASSERT_FALSE(with.any_crossing()) << i;
  }
  // What a tick takes beyond, the next ones do not have.
  EXPECT_LT(all, 50U * 2'000U + 2U * 2'000U + 2U * 22'000U);
  EXPECT_GT(with.waiting, 0U);
}

// What moved unseen is never told as clear.
TEST(ContactBudget, UnderReportWhoWaitsIsNotExamined) {
  std::uint64_t all = 0, waits_for_contact = 0;
  Sockets with(Policy::kReport, 24, 1000.0, true);
  for (int i = 0; i < 20; ++i) {
    const StepReport report = with.push(Vec3(0.3 * kGap_mm * (i % 2 == 0 ? 1 : -1), 0, 0));
    const StepCounters& counters = report.counters;
    EXPECT_EQ(counters.pairs_budget + counters.contacts_clear + counters.contacts.out +
                  counters.contacts_undecided,
              24U);
    EXPECT_GE(counters.contacts_undecided, with.unanswered);
    EXPECT_EQ(report.unexamined.size(), counters.not_examined);
    for (const UnexaminedPair& pair : report.unexamined)
      waits_for_contact += pair.why == Unexamined::kWaitsForContact ? 1 : 0;
    all += with.unanswered;
  }
  EXPECT_GT(all, 100U);
  EXPECT_GT(waits_for_contact, 100U);
}

// Somebody pushes on: who was cut short goes on in the next tick from where it was proven clear.
TEST(ContactBudget, WhoIsCutShortGetsThereLater) {
  Sockets with(Policy::kStop, 3, 60.0, true), without(Policy::kStop, 3, 60.0, false);
  const Vec3 by(0.05 * kGap_mm, 0, 0);
  for (int i = 0; i < 20; ++i) without.push(by);
  for (int i = 0; i < 120; ++i) with.push(by);
  EXPECT_GT(with.not_examined, 0U) << "nobody had to wait: nothing is shown";
  for (std::size_t i = 0; i < with.balls.size(); ++i) {
    EXPECT_GT(without.moved_mm(i), 0.9 * kGap_mm);
    EXPECT_NEAR(with.moved_mm(i), without.moved_mm(i), 2.0 * kAccuracyDefault_mm) << i;
  }
}

TEST(ContactBudget, WhereThereIsEnoughItChangesNothing) {
  Sockets with(Policy::kStop, 1, 60.0, true), without(Policy::kStop, 1, 60.0, false);
  for (int i = 0; i < 12; ++i) {
    const Vec3 by(0.3 * kGap_mm * (i % 4 < 2 ? 1 : -1), 0.01 * kGap_mm * i, 0);
    const StepReport a = with.push(by), b = without.push(by);
    ASSERT_EQ(a.state_hash, b.state_hash) << i;
    for (int rest = 0; rest < 30; ++rest) with.push(Vec3::Zero()), without.push(Vec3::Zero());
  }
  EXPECT_EQ(with.not_examined, 0U);
}

TEST(ContactBudget, TheSameAtOneAndTwoThreads) {
  Sockets one(Policy::kStop, 40, 60.0, true, 1), two(Policy::kStop, 40, 60.0, true, 2);
  for (int i = 0; i < 20; ++i) {
    const Vec3 by(0.2 * kGap_mm, 0.1 * kGap_mm * (i % 3 - 1), 0);
    ASSERT_EQ(digest(one.push(by)), digest(two.push(by))) << i;
  }
  EXPECT_GT(one.waiting + one.not_examined, 0U);
}

// Two pairs are served in a tick: everybody has a turn, held parts first.
TEST(ContactBudget, HeldPartsComeFirstAndEverybodyHasATurn) {
  Sockets some(Policy::kReport, 40, 60.0, true);
  some.push(Vec3(0.1 * kGap_mm, 0, 0));
  Scratch::Impl& work = some.scratch.impl();
  ASSERT_EQ(work.pair_count, 40U);
  std::vector<std::uint32_t> all(work.pair_count);
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    all[i] = i;
    note_waiting(work.pairs[i], WorkStage::kContact, true);
  }
  World& world = some.session.world;
  for (const std::uint32_t i : all)
    if (i % 4 != 0) world.find(some.balls[i])->holder = {};
  std::vector<int> served(all.size()), first(all.size(), -1);
  for (int tick = 0; tick < 100; ++tick) {
    std::vector<std::uint32_t> order;
    in_order(world, std::span(work.pairs).first(40), all, WorkStage::kContact, order);
    ASSERT_EQ(order.size(), all.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
      work.pairs[order[k]].effort.aged = {};
      note_waiting(work.pairs[order[k]], WorkStage::kContact, k < 2);
      if (k >= 2) continue;
      ++served[order[k]];
      if (first[order[k]] < 0) first[order[k]] = tick;
    }
  }
  for (const std::uint32_t i : all) {
    EXPECT_GT(served[i], 0) << i;
    EXPECT_TRUE(i % 4 != 0 || first[i] < 5) << i;
  }
}

TEST(WorkBudget, DebtsArePaidBeforeAnythingIsSaved) {
  World world;
  world.tick_rate_hz = 100.0;
  world.tick = 2;
  constexpr WorkRules kRules{
      .per_second = 10'000.0, .least = 10, .saved_ticks = 2, .owed_ticks = 3};
  const auto next = [&](std::int64_t saved, std::uint64_t used) {
    WorkBudget budget;
    budget.open(kRules, world, saved, true);
    EXPECT_EQ(budget.own(), 100U);
    return budget.close(used);
  };
  EXPECT_EQ(next(0, 60), 10);       // a quarter of what was not needed
  EXPECT_EQ(next(195, 0), 200);     // no more than two ticks
  EXPECT_EQ(next(0, 180), -80);     // taken in advance
  EXPECT_EQ(next(-80, 30), -10);    // paid back in full
  EXPECT_EQ(next(-80, 500), -300);  // of more than three ticks the rest is dropped
  WorkBudget budget;
  budget.open(kRules, world, -80, true);
  EXPECT_EQ(budget.left(0), 20U);
  EXPECT_EQ(budget.left(30), 0U);
  EXPECT_EQ(budget.saved(), 0U);
  world.tick = 1;
  budget.open(kRules, world, 0, true);
  EXPECT_FALSE(budget.is_limited());
  EXPECT_EQ(budget.close(1'000'000), 200);
}

// Pegs in holes that are larger by a hair, all pushed down: none is left behind for ever.
TEST(ContactBudget, FortyPushedPegsAllMove) {
  Sockets pegs(Policy::kStop, 40, 60.0, true);
  for (int i = 0; i < 60; ++i) pegs.push(Vec3(0.05 * kGap_mm, 0, 0));
  EXPECT_GT(pegs.not_examined, 0U) << "nobody had to wait: nothing is shown";
  for (std::size_t i = 0; i < pegs.balls.size(); ++i)
    EXPECT_GT(pegs.moved_mm(i), 0.1 * kGap_mm) << i;
}

}  // namespace
}  // namespace mortise
