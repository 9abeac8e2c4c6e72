// How far the real surfaces of two parts are apart: against closed forms, against parts that were
// drawn within their tolerances, and against the verdict of parts that meet.
#include "common/session/tick/pair_gap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/ccd/distance.h"
#include "common/session/tick/judge_world.h"
#include "tests/unit/depth/depth_bands.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

using namespace shapes;

constexpr std::uint64_t kWork = 30'000;

PairGap gap_of(const World& world) {
  CcdScratch scratch;
  return pair_gap(world.parts[0], world.parts[1], world.rule(PartId{1}, PartId{2}), kWork, scratch);
}

void expect_interval(const Interval& told, double lo, double hi, double accuracy_mm) {
  EXPECT_LE(told.lo, lo + 1e-9);
  EXPECT_GE(told.hi, hi - 1e-9);
  EXPECT_NEAR(told.lo, lo, accuracy_mm);
  EXPECT_NEAR(told.hi, hi, accuracy_mm);
}

struct BlockOverPlate : testing::Test {
  void SetUp() override {
    session.add("plate", box_mesh(Vec3(-50, -50, -10), Vec3(50, 50, 0)), Pose(), false);
    session.add("block", box_mesh(Vec3(-10, -10, 0), Vec3(10, 10, 20)), at(3, 4, 0.1), true);
  }
  SessionBuilder session;
};

TEST_F(BlockOverPlate, IsAsFarAsTheMeshesSayWhereNothingElseIsKnown) {
  const PairGap gap = gap_of(session.world);
  EXPECT_FALSE(gap.has_verdict);
  EXPECT_NEAR(gap.mesh_mm, 0.1, 1e-9);
  expect_interval(gap.real_mm, 0.1, 0.1, 1e-3);
}

TEST_F(BlockOverPlate, HasTheTolerancesOfBothFaces) {
  session.set_tolerance(PartId{1}, 0.006);
  session.set_tolerance(PartId{2}, 0.015);
  const PairGap gap = gap_of(session.world);
  EXPECT_FALSE(gap.has_verdict);
  EXPECT_NEAR(gap.mesh_mm, 0.1, 1e-9);
  expect_interval(gap.real_mm, 0.079, 0.121, 1e-3);
}

TEST_F(BlockOverPlate, HasTheBandsThatThePairStates) {
  session.set_tolerance(PartId{1}, 0.006);
  session.set_tolerance(PartId{2}, 0.015);
  PairRule rule;
  rule.a = PartId{1};
  rule.b = PartId{2};
  rule.band_b = std::make_shared<SurfaceBand>(session.world.parts[1].band);
  session.world.pair_rules[{rule.a, rule.b}] = rule;
  session.set_tolerance(PartId{2}, 0.05);
  expect_interval(gap_of(session.world).real_mm, 0.079, 0.121, 1e-3);
}

// Beyond the reach of what is grown the offsets alone speak, and an edge goes farther than a face.
TEST_F(BlockOverPlate, FarAwayContainsWhatIsTrue) {
  session.world.parts[1].X_WP = at(3, 4, 25.0);
  session.set_tolerance(PartId{2}, 0.015);
  expect_interval(gap_of(session.world).real_mm, 24.985, 25.015, 0.02);
}

TEST_F(BlockOverPlate, ThatMeetsItIsWhatItsVerdictSays) {
  session.set_tolerance(PartId{1}, 0.006);
  session.set_tolerance(PartId{2}, 0.015);
  for (const double z_mm : {0.01, -0.01, -0.5}) {
    session.world.parts[1].X_WP = at(3, 4, z_mm);
    const PairGap gap = gap_of(session.world);
    ASSERT_TRUE(gap.has_verdict) << z_mm;
    Scratch scratch(1);
    const PairVerdicts told = tell_pair(session.world, PartId{1}, PartId{2}, kWork, scratch);
    ASSERT_EQ(told.verdicts.size(), 1u);
    const Verdict& v = told.verdicts[0];
    EXPECT_EQ(gap.real_mm.lo, v.fake_below_mm - v.delta_mm.hi);
    EXPECT_EQ(gap.real_mm.hi, v.real_above_mm - v.delta_mm.lo);
    EXPECT_LE(gap.real_mm.lo, z_mm - 0.021 + 1e-6);
    EXPECT_GE(gap.real_mm.hi, std::min(z_mm + 0.021, 0.0) - 1e-6);
  }
}

// Two blocks whose edges face each other in one plane: pushed along it they slide past each other.
TEST(EdgesInOnePlane, HaveAGapAsNarrowAsTheirTolerances) {
  SessionBuilder session;
  session.add("below", box_mesh(Vec3(-10, -10, -10), Vec3(10, 10, 0)), Pose(), false);
  session.add("above", box_mesh(Vec3(10.5, -10, 0), Vec3(30, 10, 10)), Pose(), true);
  for (const PartId id : {PartId{1}, PartId{2}}) {
    session.set_tolerance(id, 0.01);
    Part& part = *session.world.find(id);
    part.band = grown(part.band, *part.solid, 0.0);
  }
  const PairGap gap = gap_of(session.world);
  EXPECT_NEAR(gap.mesh_mm, 0.5, 1e-9);
  // Both edges come nearer by 0.01, and none goes up or down by more.
  EXPECT_LE(gap.real_mm.lo, 0.48 + 1e-9);
  EXPECT_GE(gap.real_mm.lo, 0.44);
  EXPECT_GE(gap.real_mm.hi, std::hypot(0.52, 0.02) - 1e-9);
  EXPECT_LE(gap.real_mm.hi, 0.65);
}

// Meshes of 32 facets are up to 48 um off; a shaft in its bore is as near as their radii say.
TEST(ShaftInItsBore, HasTheGapOfItsFitWhateverItsFacets) {
  const SolidPtr shaft = solid(peg({10, -5, 15, 32, 1, 0.05}));
  const SolidPtr plate = solid(ring({10.1, 0, 20, 32, 1, 0}, 20));
  SessionBuilder session;
  session.add("shaft", shaft->mesh(), Pose(), true);
  session.add("plate", plate->mesh(), Pose(), false);
  World& world = session.world;
  world.parts[0].solid = shaft;
  world.parts[1].solid = plate;
  world.parts[0].band = cylinder_band(shaft, 10, false, Interval{-0.01, -0.0035}, "g6");
  world.parts[1].band = cylinder_band(plate, 10.1, true, Interval{-0.0105, 0.0}, "H7");
  const PairGap gap = gap_of(world);
  EXPECT_FALSE(gap.has_verdict);
  EXPECT_LT(gap.mesh_mm, 0.1);
  expect_interval(gap.real_mm, 0.1035, 0.1205, 2e-3);
}

// Blocks anyhow, and real ones drawn within their tolerances: none is nearer or farther than told.
TEST(GapsOfBlocks, HoldOfPartsThatAreDrawn) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto direction = [&]() -> Vec3 {
    return Vec3(unit(random), unit(random), unit(random)) * 2.0 - Vec3::Ones();
  };
  int compared = 0;
  double widest_mm = 0.0;
  for (int i = 0; i < 60; ++i) {
    const double t_mm[2] = {0.03 * unit(random), 0.03 * unit(random)};
    const Vec3 half(5, 7, 9);
    SessionBuilder session;
    for (int k = 0; k < 2; ++k) {
      Pose X_WP = at(0, 0, 0);
      X_WP.q = rotation_exp(3.0 * direction());
      if (k == 1) X_WP.p = direction().normalized() * 25.0;
      session.add(k == 0 ? "a" : "b", box_mesh(-half, half), X_WP, true);
      session.set_tolerance(PartId{static_cast<std::uint32_t>(k + 1)}, t_mm[k]);
      Part& part = session.world.parts.back();
      part.band = grown(part.band, *part.solid, 0.0);  // with how far its corners travel
    }
    std::vector<Part>& parts = session.world.parts;
    CcdScratch scratch;
    const DistanceResult apart =
        distance(*parts[0].solid, parts[0].X_WP, *parts[1].solid, parts[1].X_WP, scratch);
    // Half of them near, where surfaces and edges are looked at closely.
    const double wanted_mm = i % 2 == 0 ? 0.3 * unit(random) + 0.2 : apart.distance_mm;
    if (apart.distance_mm > 0.0)
      parts[1].X_WP.p +=
          (1.0 - wanted_mm / apart.distance_mm) * (apart.point_a_W - apart.point_b_W);
    const PairGap gap = gap_of(session.world);
    if (gap.has_verdict) continue;
    widest_mm = std::max(widest_mm, gap.real_mm.width());
    for (int draw = 0; draw < 40; ++draw) {
      std::shared_ptr<const Solid> real[2];
      for (int k = 0; k < 2; ++k) {
        const auto off = [&] {
          return t_mm[k] * (draw < 2 ? 1.0 - 2.0 * draw : 2.0 * unit(random) - 1.0);
        };
        const Vec3 lo(off(), off(), off()), hi(off(), off(), off());
        real[k] = std::make_shared<const Solid>(box_mesh(-half - lo, half + hi));
      }
      const double mm =
          distance(*real[0], parts[0].X_WP, *real[1], parts[1].X_WP, scratch).distance_mm;
      EXPECT_GE(mm, gap.real_mm.lo - 1e-9) << i;
      EXPECT_LE(mm, gap.real_mm.hi + 1e-9) << i;
      ++compared;
    }
  }
  EXPECT_GT(compared, 1500);
  EXPECT_LT(widest_mm, 0.25);
}

}  // namespace
}  // namespace mortise
