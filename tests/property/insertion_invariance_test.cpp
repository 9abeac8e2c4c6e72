// An insertion, step by step, says the same wherever in the world it happens, however the parts are
// turned there, and at any size.
#include <gtest/gtest.h>

#include <random>

#include "common/depth/depth.h"
#include "common/evaluation/verdict.h"
#include "common/math/rotation.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/depth_bands.h"

namespace mortise {
namespace {

using namespace shapes;

struct World {
  double scale = 1.0;
  Pose X;  // of the whole scene
};

struct Step {
  Vec3 at_mm;
  Vec3 turn_rad;
};

struct Said {
  CollisionClass collision_class = CollisionClass::kNone;
  Interval certain_mm, possible_mm;
  bool capped = false;
};

// H7/g6 at 20 mm, facets out of phase: fake while it sits straight, real when pushed or tilted far.
class PegInBore {
 public:
  explicit PegInBore(double scale) : scale_(scale) {
    const FitOffsets offsets = fit_offsets("H7/g6", 10.0);
    shaft_ = solid(scaled(peg({10, -5, 15, 32, 1, std::numbers::pi / 32}), scale));
    hole_ = solid(scaled(ring({10, 0, 20, 48, 1, 0}, 20), scale));
    shaft_band_ = cylinder_band(shaft_, 10 * scale, false, scaled_by(offsets.shaft_mm));
    hole_band_ = cylinder_band(hole_, 10 * scale, true, scaled_by(offsets.hole_mm));
  }

  Said judge(const Step& step, const Pose& X_W) const {
    OverlapQuery query;
    query.a = shaft_.get();
    query.b = hole_.get();
    query.band_a = &shaft_band_;
    query.band_b = &hole_band_;
    query.X_WB = X_W;
    query.X_WA = X_W * Pose{rotation_exp(step.turn_rad), scale_ * step.at_mm};
    query.accuracy_mm = kDepthAccuracyDefault_mm * scale_;
    CcdScratch scratch;
    const OverlapResult result = find_overlap(query, scratch);
    Said said;
    for (const OverlapRegion& region : result.regions) {
      const CollisionClass found = classify({region.delta_mm, region.certain_mm, region.possible_mm,
                                             region.has_witness, result.no_inside});
      said.capped |= region.capped;
      if (found <= said.collision_class) continue;
      said = {found, region.certain_mm, region.possible_mm, said.capped};
    }
    return said;
  }

 private:
  Interval scaled_by(const Interval& x) const { return {scale_ * x.lo, scale_ * x.hi}; }

  double scale_;
  SolidPtr shaft_, hole_;
  SurfaceBand shaft_band_, hole_band_;
};

std::vector<Step> steps(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<Step> made;
  for (int i = 0; i <= 14; ++i) {
    const double z = 26.0 - 2.0 * i;  // from clear of the mouth to well inside
    const double off = 0.004 * (i % 5), tilt = i % 3 == 2 ? 4e-4 : 0.0;
    made.push_back({Vec3(off * unit(random), off * unit(random), z),
                    Vec3(tilt * unit(random), tilt * unit(random), unit(random))});
  }
  return made;
}

TEST(InsertionInvariance, TheSameIsSaidEverywhereAndAtAnySize) {
  std::mt19937_64 random(4711);
  int told[4] = {0, 0, 0, 0};
  const PegInBore plain(1.0);
  for (int round = 0; round < test::effort(3); ++round) {
    const std::vector<Step> path = steps(random);
    for (const World& world :
         {World{1.0, random_pose(random, 100.0)}, World{1.0, random_pose(random, 2e4)},
          World{0.05, random_pose(random, 50.0)}, World{40.0, random_pose(random, 1e4)}}) {
      const PegInBore elsewhere(world.scale);
      for (std::size_t i = 0; i < path.size(); ++i) {
        const Said here = plain.judge(path[i], Pose());
        const Said there = elsewhere.judge(path[i], world.X);
        ++told[static_cast<int>(here.collision_class)];
        EXPECT_EQ(here.collision_class, there.collision_class)
            << "step " << i << ", scale " << world.scale << ": certain " << here.certain_mm.lo
            << " and " << there.certain_mm.lo << ", possible " << here.possible_mm.hi << " and "
            << there.possible_mm.hi;
        EXPECT_FALSE(here.capped || there.capped) << "step " << i;
        if (here.collision_class == CollisionClass::kNone) continue;
        // Both brackets hold the same number.
        const double slack = 2e-5 + 1e-9 * world.X.p.norm() / world.scale;
        EXPECT_LE(here.certain_mm.lo, there.certain_mm.hi / world.scale + slack);
        EXPECT_GE(here.certain_mm.hi, there.certain_mm.lo / world.scale - slack);
      }
    }
  }
  std::printf("%d nothing, %d fake, %d potential, %d real\n", told[0], told[1], told[2], told[3]);
  for (const int count : told) EXPECT_GT(count, 0);
}

// An error of a hundredth of the clearance is no rounding: it is seen.
TEST(InsertionInvariance, AShiftOfAMicrometreIsSeen) {
  const PegInBore plain(1.0);
  const Step step{Vec3(0.0069, 0.0, 10.0), Vec3::Zero()},
      shifted{Vec3(0.0079, 0.0, 10.0), Vec3::Zero()};
  const Said here = plain.judge(step, Pose()), there = plain.judge(shifted, Pose());
  EXPECT_LT(here.certain_mm.hi + 5e-4, there.certain_mm.lo);
}

}  // namespace
}  // namespace mortise
