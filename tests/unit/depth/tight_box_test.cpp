// The tight box of a part within a box holds every point of it there, moved faces included.
#include "common/depth/cells/tight_box.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/evaluation/band.h"
#include "common/geometry/signed_distance.h"
#include "tests/support/shapes.h"
#include "tests/unit/depth/random_polyhedra.h"

namespace mortise {
namespace {

constexpr double kBand_mm = 0.05, kDepth_mm = 0.1;

bool is_within(const Box& box, const Vec3& x) {
  return (box.lo.array() <= x.array()).all() && (x.array() <= box.hi.array()).all();
}

PlaneFaces plane_faces_of(const Solid& solid) {
  BandInput input;
  input.solid = &solid;
  input.rest = {{-kBand_mm, kBand_mm}, "profile"};
  return find_plane_faces(solid, build_band(input));
}

using polyhedra::between;
using polyhedra::Random;

// Evenly spread over the decades.
double spread(Random& random, double lo, double hi) {
  return lo * std::pow(hi / lo, between(random, 0.0, 1.0));
}

struct BoxTally {
  int boxes = 0, empty = 0, halved = 0, points = 0, outside = 0;
};

// Points of the part, and those that its faces come to at least.
void look_around(const SharpPart& part, const Pose& X_BS, const Box& box, Random& random,
                 BoxTally& tally) {
  const Box tight = tight_box(part, X_BS, box, kDepth_mm);
  ++tally.boxes;
  tally.empty += tight.empty();
  tally.halved += !tight.empty() && (tight.hi - tight.lo).prod() < 0.5 * (box.hi - box.lo).prod();
  for (int i = 0; i < 200; ++i) {
    Vec3 at;
    for (int k = 0; k < 3; ++k) at[k] = between(random, box.lo[k], box.hi[k]);
    if (signed_distance_mm(*part.solid, X_BS.inverse() * at) > kBand_mm + kDepth_mm) continue;
    ++tally.points;
    tally.outside += !is_within(tight, at);
  }
}

BoxTally look_at(const SolidPtr& solid, std::uint64_t seed) {
  const PlaneFaces planes = plane_faces_of(*solid);
  Random random(seed);
  BoxTally tally;
  for (int i = 0; i < 300; ++i) {
    const Pose X_BS = shapes::random_pose(random, 10.0);
    const auto& points = solid->mesh().points_mm;
    const Vec3 near = X_BS * points[static_cast<std::size_t>(between(random, 0.0, 0.999) *
                                                             static_cast<double>(points.size()))];
    const Vec3 center = near + spread(random, 0.1, 10.0) * polyhedra::direction(random);
    Box box{center, center};
    for (int k = 0; k < 3; ++k) {
      box.lo[k] -= spread(random, 0.05, 8.0);
      box.hi[k] += spread(random, 0.05, 8.0);
    }
    look_around({solid.get(), &planes}, X_BS, box, random, tally);
  }
  return tally;
}

TEST(TightBox, HoldsEveryPointOfThePartThere) {
  int seed = 1;
  for (const SolidPtr& solid :
       {shapes::solid(shapes::box({20, 15, 10}, Vec3::Zero(), 9)),
        shapes::solid(shapes::ring({12, -10, 10, 48, 3, 0}, 25)),
        shapes::solid(shapes::u_slot(12, 7, 15, 5, -12, 12)), shapes::solid(shapes::sphere(20))}) {
    const BoxTally tally = look_at(solid, static_cast<std::uint64_t>(seed++));
    EXPECT_GT(tally.points, 2000);
    EXPECT_GT(tally.halved, 5);
    EXPECT_GT(tally.empty, 5);
    EXPECT_EQ(tally.outside, 0) << tally.points << " points in " << tally.boxes << " boxes";
  }
}

}  // namespace
}  // namespace mortise
