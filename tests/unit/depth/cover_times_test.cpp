// Times and places that covers tell by themselves, without a search.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/depth/depth.h"
#include "common/math/rotation.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/cover_parts.h"

namespace mortise {
namespace {

using cover_parts::DrawnPart;
using cover_parts::Random;
using cover_parts::uniform;

DrawnPart block_of(Random& random, double x_mm, double y_mm, double z_mm) {
  return cover_parts::finish(
      random, *generate("block", {{"x_mm", x_mm}, {"y_mm", y_mm}, {"z_mm", z_mm}}), 0.01);
}

OverlapQuery overlap_of(const DrawnPart& a, const DrawnPart& b) {
  OverlapQuery query;
  query.a = a.solid.get();
  query.b = b.solid.get();
  query.band_a = &a.band;
  query.band_b = &b.band;
  return query;
}

// A block stands on its edge above a plate and rocks by `angle` to both sides, the edge `dip_mm`
// deep in the least plate in the middle.
SweptQuery rocking(const DrawnPart& block, const DrawnPart& plate, double angle, double dip_mm) {
  const double x_mm = 10.0 + block.offsets.at("right").lo,
               z_mm = 10.0 + block.offsets.at("bottom").lo;
  const double reach_mm = std::hypot(x_mm, z_mm), down = std::atan2(x_mm, z_mm);
  const Vec3 at(0.0, 0.0, 10.0 + plate.offsets.at("top").lo + reach_mm - dip_mm);
  SweptQuery query;
  query.at_target = overlap_of(block, plate);
  query.motion_a = linear_motion({rotation_exp((down - angle) * Vec3::UnitY()), at},
                                 {rotation_exp((down + angle) * Vec3::UnitY()), at}, Vec3::Zero());
  query.motion_b = still_motion(Pose());
  return query;
}

TEST(CoverTimes, WhoGrazesAWallNeedsNoSearch) {
  Random random(7101);
  CcdScratch scratch;
  for (int i = 0; i < test::effort(20); ++i) {
    const DrawnPart block = block_of(random, 20.0, 20.0, 20.0),
                    plate = block_of(random, 80.0, 80.0, 20.0);
    const SweptQuery grazing = rocking(block, plate, 4e-3, 0.8e-6);
    std::uint64_t work = 0;
    EXPECT_LT(certain_free_until(grazing, work).t, 0.5);
    const InterferenceTime free = find_interference_time(grazing, scratch);
    EXPECT_FALSE(free.becomes_real || free.capped);
    EXPECT_EQ(free.t_free, 1.0);
    EXPECT_LT(free.evaluations, 150u);
    const InterferenceTime real =
        find_interference_time(rocking(block, plate, 0.08, 0.02), scratch);
    EXPECT_TRUE(real.becomes_real);
    EXPECT_LT(real.t_free, 0.5);
  }
}

// The edge of one block crosses that of another, 0.1 um beside it, and turns about it: what keeps
// both apart turns too.
TEST(CoverTimes, EdgesThatTurnAboutEachOtherNeedFewSpans) {
  constexpr double kGap_mm = 1e-4, kTurn_rad = 0.05;
  Random random(7103);
  for (int i = 0; i < test::effort(20); ++i) {
    const DrawnPart above = block_of(random, 20.0, 20.0, 20.0),
                    below = block_of(random, 20.0, 20.0, 20.0);
    const Vec3 edge_above(10.0 + above.offsets.at("right").lo, 0.0,
                          -10.0 - above.offsets.at("bottom").lo),
        edge_below(10.0 + below.offsets.at("right").lo, 0.0, 10.0 + below.offsets.at("top").lo);
    const auto turned_up = [](const Vec3& edge, double up) {
      return Quat::FromTwoVectors(edge, up * Vec3::UnitZ());
    };
    const Quat down =
        rotation_exp(0.5 * std::numbers::pi * Vec3::UnitZ()) * turned_up(edge_above, -1.0);
    SweptQuery query;
    query.at_target = overlap_of(above, below);
    const Quat up = turned_up(edge_below, 1.0);
    query.motion_b = still_motion({up, -(up * edge_below)});
    const auto at = [&](double angle) {
      const Quat q = rotation_exp(angle * Vec3::UnitY()) * down;
      return Pose{q,
                  rotation_exp(angle * Vec3::UnitY()) * Vec3(0.0, 0.0, kGap_mm) - q * edge_above};
    };
    const Vec3 on_the_other_edge = edge_above * (1.0 + kGap_mm / edge_above.norm());
    query.motion_a = linear_motion(at(-kTurn_rad), at(kTurn_rad), on_the_other_edge);
    std::uint64_t work = 0;
    EXPECT_EQ(certain_free_until(query, work).t, 1.0) << i;
    EXPECT_LT(work, 300u) << i;
  }
}

// Two long blocks whose edges cross side by side: the depth is the same wherever both are.
TEST(CoverTimes, WhereEdgesRunSideBySideAPlaceIsNamed) {
  Random random(7102);
  int named = 0, asked = 0;
  for (int i = 0; i < test::effort(200); ++i) {
    const DrawnPart a = block_of(random, 10.0, 10.0, uniform(random, 10.0, 40.0)),
                    b = block_of(random, 10.0, 10.0, uniform(random, 10.0, 40.0));
    OverlapQuery query = overlap_of(a, b);
    const double deep_mm = std::exp(uniform(random, std::log(1e-3), std::log(0.5)));
    const Vec3 axis = Vec3::UnitZ();
    query.X_WA = {rotation_exp(uniform(random, 0.0, 3.0) * axis),
                  {0.0, 0.0, uniform(random, -15.0, 15.0)}};
    query.X_WB.q = rotation_exp(uniform(random, 0.0, 3.0) * axis);
    // Up to where it is that deep, by halving.
    const double towards = uniform(random, 0.0, 6.0);
    double in = 0.0, out = 20.0;
    const auto depth_at = [&](double far_mm) {
      query.X_WB.p = far_mm * Vec3(std::cos(towards), std::sin(towards), 0.0);
      query.use_covers = false;
      query.refinement = Refinement::kDecided;
      CcdScratch scratch;
      double most = 0.0;
      for (const OverlapRegion& region : find_overlap(query, scratch).regions)
        if (region.has_witness) most = std::max(most, region.certain_mm.lo);
      return most;
    };
    for (int k = 0; k < 24; ++k)
      (depth_at(0.5 * (in + out)) > deep_mm ? in : out) = 0.5 * (in + out);
    if (!(depth_at(in) > 0.5 * deep_mm)) continue;
    ++asked;
    query.use_covers = true;
    query.want_delta = false;
    std::uint64_t work = 0;
    named += said_by_covers(query, Named::kLeast, work).place.has_value();
  }
  std::printf("%d of %d named\n", named, asked);
  EXPECT_GT(asked, test::effort(100));
  EXPECT_GE(50 * named, 49 * asked);
}

}  // namespace
}  // namespace mortise
