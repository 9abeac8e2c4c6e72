// What a tick may spend on depth: pairs wait, are counted, and nothing is forgotten.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/session/tick/tick_work.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

// Pegs with tolerances, each in front of its own wall.
struct Row {
  SessionBuilder session;
  Scratch scratch;
  UserId ada;
  std::vector<PartId> pegs;

  explicit Row(Policy policy, bool budget, int pegs_wanted = 24) : session(policy) {
    session.world.tick_rate_hz = 1000.0;  // the least work that a tick may have
    ada = session.join("ada");
    for (int i = 0; i < pegs_wanted; ++i) {
      const double y = 10.0 * i;
      session.add("wall", box_mesh(Vec3(0, -3, -3), Vec3(4, 3, 3)), at(0, y, 0), false);
      pegs.push_back(session.add("peg", cube_mesh(2), at(-5, y, 0), true));
      session.set_tolerance(pegs.back(), 0.05);
      session.grab(ada, pegs.back());
    }
    scratch.impl().switches.work_budget = budget;
  }
  // Each peg and its wall have a plane through their middle in common.
  void keep_heights() {
    const Element level{ElementKind::kPlane, Vec3::Zero(), Vec3::UnitZ()};
    for (const PartId peg : pegs) {
      const PartId wall{peg.value - 1};
      session.world.guides.push_back({ConstraintId{session.world.next_constraint++},
                                      ada,
                                      {ConstraintKind::kCoplanar, {peg, "a"}, {wall, "b"}},
                                      {level, level, false, 0.0}});
    }
  }
  StepReport push(const Vec3& by) {
    std::vector<Increment> increments;
    for (const PartId peg : pegs) increments.push_back(session.push(ada, peg, by));
    return play_tick(session.world, increments, scratch);
  }
  StepReport rest() { return play_tick(session.world, {}, scratch); }
  // The open clashes, by part and class.
  std::vector<std::string> told() {
    std::vector<std::string> all;
    for (const ClashEvent& clash : snapshot_of(session.world).open_clashes)
      all.push_back(std::to_string(clash.part_b.value) + " " +
                    std::to_string(static_cast<int>(clash.verdict.collision_class)));
    std::sort(all.begin(), all.end());
    return all;
  }
  std::size_t open_reals() {
    std::size_t count = 0;
    for (const ClashEvent& clash : snapshot_of(session.world).open_clashes)
      count += clash.verdict.collision_class == CollisionClass::kReal ? 1 : 0;
    return count;
  }
};

TEST(WorkBudget, PairsThatWaitAreCountedAndJudgedLater) {
  Row with(Policy::kReport, true), without(Policy::kReport, false);
  with.push(Vec3(3.5, 0, 0));
  without.push(Vec3(3.5, 0, 0));
  const StepReport all = without.push(Vec3(1.0, 0, 0));
  const StepReport some = with.push(Vec3(1.0, 0, 0));
  EXPECT_EQ(all.events.size(), without.pegs.size());
  EXPECT_EQ(all.counters.pairs_waiting, 0U);
  EXPECT_LT(some.counters.depth_evaluations, all.counters.depth_evaluations);
  EXPECT_GT(some.counters.pairs_waiting, 0U);
  EXPECT_GE(some.counters.not_examined, some.counters.pairs_waiting);
  EXPECT_EQ(some.unexamined.size(), some.counters.pairs_waiting);
  for (const UnexaminedPair& pair : some.unexamined) {
    EXPECT_EQ(pair.why, Unexamined::kWaitsForDepth);
    EXPECT_EQ(pair.b.value, pair.a.value + 1) << "a wall and its peg";
  }
  EXPECT_TRUE(all.unexamined.empty());
  EXPECT_LT(with.open_reals(), with.pegs.size());
  // Nobody pushes any more: what was owed is told all the same.
  for (int i = 0; i < 200 && with.open_reals() < with.pegs.size(); ++i) with.rest();
  EXPECT_EQ(with.open_reals(), with.pegs.size());
  EXPECT_EQ(with.rest().counters.depth_evaluations, 0U) << "nothing is owed any more";
}

TEST(WorkBudget, WhoWaitsIsNotLetIntoAnything) {
  Row with(Policy::kStop, true);
  std::uint64_t waiting = 0;
  for (int i = 0; i < 60; ++i) waiting += with.push(Vec3(0.25, 0, 0)).counters.pairs_waiting;
  EXPECT_GT(waiting, 0U);
  for (const PartId peg : with.pegs) {
    // Face to face at x = -1; least surfaces meet 0.05 mm later.
    EXPECT_LE(with.session.pose(peg).p.x(), -0.95 + 1e-3);
    EXPECT_GE(with.session.pose(peg).p.x(), -1.0 - 0.11) << "held back for ever";
  }
}

// Who waits goes on with what it was pushed by, as soon as there is work: nothing that was accepted
// is lost, and pushes there and back come to nothing.
void expect_pushes_are_kept(bool guided) {
  Row with(Policy::kStop, true), without(Policy::kStop, false);
  std::uint64_t waiting = 0;
  for (Row* row : {&with, &without}) {
    if (guided) row->keep_heights();
    // Into what the tolerance leaves open, then along the walls.
    for (int i = 0; i < 8; ++i) row->push(Vec3(0.5025, 0, 0));
    for (int i = 0; i < 12; ++i) {
      const StepReport report = row->push(Vec3(0, i % 2 == 0 ? 0.04 : -0.03, 0));
      if (row == &with) waiting += report.counters.pairs_waiting;
      EXPECT_EQ(report.counters.pushes_cut, 0U);
    }
    for (int i = 0; i < 200; ++i) row->rest();
  }
  EXPECT_GT(waiting, 0U) << "nobody had to wait: nothing is shown";
  for (std::size_t i = 0; i < with.pegs.size(); ++i)
    EXPECT_LT((with.session.pose(with.pegs[i]).p - without.session.pose(without.pegs[i]).p).norm(),
              1e-6)
        << "peg " << i;
}

TEST(WorkBudget, WhoWaitsKeepsItsPushes) { expect_pushes_are_kept(false); }

// The faces along which the pegs are guided do not take a push away.
TEST(WorkBudget, WhoWaitsOnAConstraintKeepsItsPushes) { expect_pushes_are_kept(true); }

TEST(WorkBudget, PushedOnAgainstTheSamePlaceNothingIsSearched) {
  Row one(Policy::kStop, true, 1);
  for (int i = 0; i < 40; ++i) one.push(Vec3(0.25, 0, 0));
  const double stands = one.session.pose(one.pegs[0]).p.x();
  std::uint64_t held = 0, evaluations = 0;
  for (int i = 0; i < 20; ++i) {
    const StepReport report = one.push(Vec3(0.25, 0.01, 0));
    held += report.counters.pairs_held_again;
    evaluations += report.counters.depth_evaluations;
  }
  EXPECT_GE(held, 15U);
  EXPECT_LT(evaluations, 2'000U);
  EXPECT_EQ(one.session.pose(one.pegs[0]).p.x(), stands);
  EXPECT_EQ(one.open_reals(), 1U);
  one.push(Vec3(-0.25, 0, 0));
  EXPECT_NEAR(one.session.pose(one.pegs[0]).p.x(), stands - 0.25, 1e-9);
}

// What was said of a clash holds while nobody has the work to look again: pegs stir in their walls,
// and nothing begins, ends or changes its class, however few of them are looked at in a tick.
TEST(WorkBudget, WhatIsNotJudgedStaysToldAsItWas) {
  Row with(Policy::kReport, true), without(Policy::kReport, false);
  for (Row* row : {&with, &without}) {
    for (const double by : {3.5, 1.0}) row->push(Vec3(by, 0, 0));
    for (int i = 0; i < 400 && row->open_reals() < row->pegs.size(); ++i) row->rest();
    ASSERT_EQ(row->open_reals(), row->pegs.size());
  }
  std::uint64_t waiting = 0;
  for (int i = 0; i < 40; ++i) {
    const Vec3 by(i % 2 == 0 ? 0.01 : -0.01, 0.001, 0);
    without.push(by);
    const StepReport report = with.push(by);
    waiting += report.counters.pairs_waiting;
    for (const ClashEvent& event : report.events)
      ADD_FAILURE() << "tick " << event.tick << ": told again, as " << static_cast<int>(event.kind);
  }
  EXPECT_GT(waiting, 100U);
  for (int i = 0; i < 400; ++i) with.rest();
  without.rest();
  EXPECT_EQ(with.told(), without.told());
  // Out of the walls: who had no work to see it ends its clash later, and all do.
  without.push(Vec3(-4, 0, 0));
  with.push(Vec3(-4, 0, 0));
  EXPECT_EQ(without.open_reals(), 0U);
  for (int i = 0; i < 400; ++i) with.rest();
  EXPECT_EQ(with.told(), without.told());
}

// Many pegs are to be looked at anew, one of them is in a hand: that one is not kept waiting.
TEST(WorkBudget, WhatUsersHoldComesFirst) {
  Row row(Policy::kReport, true);
  for (const double by : {3.5, 1.0}) row.push(Vec3(by, 0, 0));
  row.session.world.tick_rate_hz = 600.0;
  const PartId held = row.pegs.back();
  for (const PartId peg : row.pegs)
    if (peg != held) row.session.command(row.ada, peg, CommandKind::kRelease);
  for (int i = 0; i < 400; ++i) row.rest();
  ASSERT_EQ(row.open_reals(), row.pegs.size());
  // Its clash ends and begins with every push, but for those at which it needs more than it did.
  int told = 0;
  for (int i = 0; i < 20; ++i) {
    Decision change;
    for (const PartId peg : row.pegs)
      if (peg != held) note_surface(row.session.world, peg, PartId{}, change);
    const Vec3 out(i % 2 == 0 ? -2 : 2, 0, 0);
    const StepReport report =
        play_tick(row.session.world, {row.session.push(row.ada, held, out)}, row.scratch);
    EXPECT_GT(report.counters.pairs_waiting, 0U);
    for (const ClashEvent& event : report.events) told += event.part_b == held ? 1 : 0;
  }
  EXPECT_GE(told, 14) << "the peg in the hand waits behind others";
}

// A session for three threads has their work in its ticks, on however many it is played.
TEST(WorkBudget, GrowsWithTheThreadsOfTheSession) {
  World world;
  world.tick = 2;
  const WorkRules rules{.per_second = 60'000.0, .least = 500, .saved_ticks = 2, .owed_ticks = 1};
  for (const auto& [threads, own] : {std::pair(1, 1'000U), {2, 1'700U}, {4, 3'100U}}) {
    world.threads = threads;
    WorkBudget budget;
    budget.open(rules, world, 0, true);
    EXPECT_EQ(budget.own(), own);
  }
  std::uint64_t waiting[2] = {0, 0};
  for (const int threads : {1, 3}) {
    Row row(Policy::kStop, true);
    row.session.world.threads = threads;
    for (int i = 0; i < 40; ++i)
      waiting[threads == 3] += row.push(Vec3(0.25, 0, 0)).counters.pairs_waiting;
  }
  EXPECT_GT(waiting[0], 20U) << "nothing is shown";
  EXPECT_LT(2 * waiting[1], waiting[0]);
}

TEST(WorkBudget, ThreadsChangeNothing) {
  Row one(Policy::kStop, true), two(Policy::kStop, true);
  one.session.world.threads = two.session.world.threads = 2;
  Scratch threads(3);
  for (int i = 0; i < 40; ++i) {
    std::vector<Increment> same;
    for (const PartId peg : two.pegs)
      same.push_back(two.session.push(two.ada, peg, Vec3(0.25, 0, 0)));
    EXPECT_EQ(one.push(Vec3(0.25, 0, 0)).state_hash,
              play_tick(two.session.world, same, threads).state_hash);
  }
}

}  // namespace
}  // namespace mortise
