// However many push at once, nobody who provably leaves or slides waits for the others.
#include "tests/bench/pushed_pegs.h"

#include <gtest/gtest.h>

#include <map>

#include "common/session/memory/session_state.h"
#include "common/session/tick/judge_world.h"
#include "tests/bench/scenes.h"

namespace mortise::bench {
namespace {

struct PairClass {
  CollisionClass told = CollisionClass::kNone, judged = CollisionClass::kNone;
};

// The worst class of each pair, as it is told and as a fresh look finds it.
std::map<PartPair, PairClass> classes_of(World& world) {
  std::map<PartPair, PairClass> classes;
  for (const auto& [pair, open] : world.state->open)
    for (const OpenClash& clash : open)
      classes[pair].told = std::max(classes[pair].told, clash.last.verdict.collision_class);
  Scratch scratch;
  for (const PairVerdicts& pair : judge_world(world, scratch, false).pairs)
    for (const Verdict& verdict : pair.verdicts) {
      PairClass& of = classes[{pair.a, pair.b}];
      of.judged = std::max(of.judged, verdict.collision_class);
    }
  return classes;
}

TEST(PushedPegs, WhoIsPushedAwayFromTheWallGoes) {
  const Shaken shaken = shake_all({"1 mm clearance", 19.0, ""}, 64, 20);
  EXPECT_EQ(shaken.carried_out, shaken.away);
}

TEST(PushedPegs, SixtyFourGoAsFarAsOne) {
  for (const char* policy : {"stop", "slide"}) {
    const Fit fit{"0.1 mm clearance", 19.9, ""};
    const Pushed one = push_all(fit, 1, policy, 20), all = push_all(fit, 64, policy, 20);
    EXPECT_GT(all.mm_a_tick, 0.9 * one.mm_a_tick) << policy;
    EXPECT_GT(all.least_mm_a_tick, 0.5 * one.mm_a_tick) << policy;
  }
}

// What is told goes on without a look as long as covers prove it. A look at the poses that were
// reached says nothing worse, and what is over ends once the pegs rest.
TEST(PushedPegs, WhatGoesOnIsWhatALookSays) {
  std::uint64_t went_on = 0;
  for (const Fit& fit : {Fit{"0.1 mm clearance", 19.9, ""}, Fit{"H7/g6", 20.0, "Ø20 H7/g6"},
                         Fit{"H7/k6", 20.0, "Ø20 H7/k6"}})
    for (const char* policy : {"report", "stop"}) {
      SCOPED_TRACE(std::string(fit.name) + ", " + policy);
      Pegs pegs(fit, 3, policy);
      Dice dice(29);
      for (int tick = 0; tick < 60; ++tick) {
        std::vector<Vec3> by;
        for (int i = 0; i < pegs.count(); ++i)
          by.emplace_back(dice.between(-0.01, 0.01), dice.between(-0.01, 0.01), 0.05);
        if (tick >= 50) by.assign(by.size(), Vec3::Zero());
        const StepReport report = pegs.push(by, Vec3::Zero());
        went_on += report.counters.pairs_held_again;
        if (report.counters.not_examined > 0 || tick % 4 != 0) continue;
        const bool rest = tick >= 56, held = std::string(policy) == "stop";
        for (const auto& [pair, told] : classes_of(pegs.world())) {
          EXPECT_GE(told.told, told.judged) << "tick " << tick;
          // A better class is told where it is left by enough; nothing at all needs no more.
          if (rest && !held && told.judged == CollisionClass::kNone) {
            EXPECT_EQ(told.told, CollisionClass::kNone) << "tick " << tick;
          }
        }
      }
    }
  EXPECT_GT(went_on, 100U);
}

}  // namespace
}  // namespace mortise::bench
