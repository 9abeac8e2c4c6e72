// Policy slide with tolerances and fits: a peg that meets the mouth of its bore beside its middle
// slides over its chamfer and drops in.
#include <gtest/gtest.h>

#include <cstdio>
#include <random>
#include <vector>

#include "common/io/scenario/scene_load.h"
#include "common/session/tick/step.h"
#include "common/session/world/decisions.h"

namespace mortise {
namespace {

class SlideFit : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto reading = read_scenario(MORTISE_SOURCE_DIR "/scenarios/peg_in_hole.yaml");
    ASSERT_TRUE(reading && reading->usable());
    auto loaded = load_scene(reading->scenario, default_meshes());
    ASSERT_TRUE(loaded && loaded->usable());
    scene_ = loaded->world;
  }

  struct Push {
    Vec3 by;
    int ticks;
  };
  /// The peg stands at `from` (its bore's mouth is at z = 15, its middle at x = y = 0) and is
  /// pushed so in each tick.
  Vec3 push(const std::string& name, Policy policy, const Vec3& from,
            const std::vector<Push>& pushes) {
    World world = scene_;
    world.policy = policy;
    Decision join;
    join.kind = Decision::Kind::kJoin;
    join.user_name = name == "peg_g6" ? "ann" : name == "peg_k6" ? "bob" : "cid";
    apply_decision(world, join);
    Part& peg = *world.find(world.find_part(name)->id);
    peg.holder = world.users.back().id;
    const Vec3 middle(peg.X_WP.p.x(), peg.X_WP.p.y(), 0.0);
    peg.X_WP.p = middle + from;
    Scratch scratch;
    std::uint64_t seq = 0;
    for (const Push& one : pushes)
      for (int i = 0; i < one.ticks; ++i) {
        Increment increment;
        increment.user = peg.holder;
        increment.part = peg.id;
        increment.seq = ++seq;
        increment.translation_mm = one.by;
        step(world, {&increment, 1}, scratch);
      }
    return peg.X_WP.p - middle;
  }

  World scene_;
};

// A push straight down beside the middle, by up to 0.4 mm of a chamfer of 1 mm: the most drop in
// (34 of 40 when this was written, none under stop); who does, fits.
TEST_F(SlideFit, OverItsChamferIntoItsBore) {
  constexpr int kTries = 12, kLeast = 8;
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  int dropped = 0;
  for (int i = 0; i < kTries; ++i) {
    Vec3 off(u(rng), u(rng), 0.0);
    off *= 0.4 * (i + 1) / kTries / off.norm();
    const Vec3 at = push("peg_g6", Policy::kSlide, off + Vec3(0, 0, 15.5), {{{0, 0, -0.4}, 60}});
    if (at.z() > 5.0) continue;
    ++dropped;
    // H7/g6: the bore leaves it 20.5 um at most.
    EXPECT_LT(at.head<2>().norm(), 0.0206) << at.transpose();
  }
  std::printf("%d of %d dropped in\n", dropped, kTries);
  EXPECT_GE(dropped, kLeast);
}

TEST_F(SlideFit, UnderStopItStaysAtTheMouth) {
  const Vec3 at = push("peg_g6", Policy::kStop, {0.3, 0.1, 15.5}, {{{0, 0, -0.4}, 60}});
  EXPECT_GT(at.z(), 14.0) << at.transpose();
}

TEST_F(SlideFit, WhatIsLargerThanItsBoreDoesNotDropIn) {
  // H7/p6: even the least peg is larger than the largest bore.
  const Vec3 at = push("peg_p6", Policy::kSlide, {0.2, 0.1, 15.5}, {{{0, 0, -0.4}, 40}});
  EXPECT_GT(at.z(), 13.5) << at.transpose();
}

TEST_F(SlideFit, DraggedOverThePlateItDropsIn) {
  const Vec3 at = push("peg_g6", Policy::kSlide, {-2.0, 0.002, 15.2},
                       {{{0.15, 0, -0.3}, 12}, {{0, 0, -0.3}, 40}});
  EXPECT_LT(at.z(), 8.0) << at.transpose();
}

}  // namespace
}  // namespace mortise
