// distance(A, B) to rounding, with witness points, against every pair of triangles in long double.
#include <gtest/gtest.h>

#include <cmath>

#include "common/ccd/distance.h"
#include "tests/stress/random_cases.h"
#include "tests/stress/record.h"
#include "tests/support/effort.h"
#include "tests/support/numbers.h"

namespace mortise::stress {
namespace {

struct Found {
  int apart = 0, crossing = 0;
};

Point in_world(const Solid& solid, const Pose& X, std::uint32_t i, int k) {
  return placement_of(X)(point_of(solid.mesh().corner(i, k)));
}

// Worst of: distance against the twin, witness points from their triangles, their distance from
// what is said.
double error_of(const Case& c, const DistanceResult& d, Real truth) {
  Real worst = std::abs(truth - d.distance_mm);
  Corners a, b;
  for (int k = 0; k < 3; ++k) {
    a[k] = in_world(*c.a, c.motion_a.X_W0, d.triangle_a, k);
    b[k] = in_world(*c.b, c.motion_b.X_W0, d.triangle_b, k);
  }
  const Point on_a = point_of(d.point_a_W), on_b = point_of(d.point_b_W);
  worst = std::max({worst, distance_to(on_a, a), distance_to(on_b, b)});
  if (d.distance_mm > 0.0) worst = std::max(worst, std::abs(norm(on_a - on_b) - truth));
  return static_cast<double>(worst);
}

// The scene of a case at its start.
void compare(Sweep& sweep, const Case& c, const std::string& label, Found& found) {
  thread_local CcdScratch scratch;
  DistanceResult d;
  {
    const FloatGuard guard(label);
    d = distance(*c.a, c.motion_a.X_W0, *c.b, c.motion_b.X_W0, scratch);
  }
  Oracle oracle(c);
  const double rounding = oracle.rounding_mm();
  const Real gap = oracle.gap_mm(0.0, 1e30L);
  ASSERT_TRUE(d.within_limit) << label;
  if (gap < 0) {
    ++found.crossing;
    // What crosses by less than rounding may still be seen apart by less.
    sweep.measured(d.distance_mm / rounding, 1.0, label + ", crossing");
    return;
  }
  ++found.apart;
  sweep.measured(error_of(c, d, gap) / rounding, 1.0, label);
  if (!(gap > 4.0L * rounding)) return;
  const double near_mm = static_cast<double>(gap) - 2.0 * rounding;
  const double far_mm = static_cast<double>(gap) + 2.0 * rounding;
  const auto limited = [&](double limit_mm) {
    return distance(*c.a, c.motion_a.X_W0, *c.b, c.motion_b.X_W0, scratch, limit_mm);
  };
  EXPECT_FALSE(limited(near_mm).within_limit) << label;
  EXPECT_EQ(limited(near_mm).distance_mm, near_mm) << label;
  EXPECT_NEAR(limited(far_mm).distance_mm, d.distance_mm, rounding) << label;
}

Case still_case(std::uint64_t seed) {
  Case c = random_case(seed);
  c.separation_mm = 0.0;
  c.motion_a = still_motion(c.motion_a.pose_at(static_cast<double>(seed % 7) / 10.0));
  c.motion_b = still_motion(c.motion_b.X_W0);
  return c;
}

TEST(Distance, ScalesAndOffsets) {
  for (const double factor : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
    char name[64];
    std::snprintf(name, sizeof name, "distance, scale %.0e (in roundings)", factor);
    Sweep sweep(name);
    Found found;
    for (int i = 0; i < test::effort(150); ++i) {
      const std::uint64_t seed = 800'000 + static_cast<std::uint64_t>(i);
      compare(sweep, scaled(still_case(seed), factor), "distance " + std::to_string(seed), found);
    }
    EXPECT_GT(found.apart, 80);
    EXPECT_GT(found.crossing, 10);
  }
  for (const double far_mm : {1e3, 1e5, 1e7}) {
    char name[64];
    std::snprintf(name, sizeof name, "distance, offset %.0e mm (in roundings)", far_mm);
    Sweep sweep(name);
    Found found;
    for (int i = 0; i < test::effort(150); ++i) {
      const std::uint64_t seed = 810'000 + static_cast<std::uint64_t>(i);
      std::mt19937_64 random(seed);
      const Vec3 away = far_mm * random_turn(random, 1.0).normalized();
      const Case c = still_case(seed);
      const Pose G{rotation_exp(random_turn(random, kPi)), away};
      compare(sweep, i % 2 == 0 ? moved(c, G) : with_far_mesh(c, away),
              "distance " + std::to_string(seed), found);
    }
    EXPECT_GT(found.apart, 80);
  }
}

// Down to gaps of rounding: feet so near that their difference has no digits left.
TEST(Distance, DownToRounding) {
  Sweep sweep("distance, gaps 1e-1 ... 1e-14 mm (in roundings)");
  Found found;
  CcdScratch scratch;
  for (int i = 0; i < test::effort(300); ++i) {
    const std::uint64_t seed = 820'000 + static_cast<std::uint64_t>(i);
    Case c = random_case(seed);
    c.separation_mm = std::pow(10.0, -1.0 - i % 14);
    c.accuracy_mm = 1e-12;
    const FirstContact stop = first_contact(query_of(c), scratch);
    if (stop.state != ContactState::kContact) continue;
    c.motion_a = still_motion(c.motion_a.pose_at(stop.t_contact));
    c.motion_b = still_motion(c.motion_b.pose_at(stop.t_contact));
    c.separation_mm = 0.0;
    compare(sweep, c, "gap after " + std::to_string(seed), found);
  }
  EXPECT_GT(found.apart, 150);
}

// Sheets and needles; common planes, corner on corner.
TEST(Distance, DegenerateMeshes) {
  Sweep sweep("distance, sheets to aspect 1e8 (in roundings)");
  Found found;
  for (int i = 0; i < test::effort(200); ++i) {
    const std::uint64_t seed = 830'000 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    Case c = still_case(seed);
    const double by = std::pow(10.0, -2.0 - 2.0 * (i % 4));
    const auto squeezed = [&](const SolidPtr& part) {
      TriangleMesh mesh = part->mesh();
      const Vec3 n = random_turn(random, 1.0).normalized();
      for (Vec3& p : mesh.points_mm) p -= (1.0 - by) * n.dot(p) * n;
      return testing::solid(mesh);
    };
    c.a = squeezed(c.a);
    if (i % 2 == 0) c.b = squeezed(c.b);
    compare(sweep, c, "sheet " + std::to_string(seed), found);
  }
  Sweep grid("distance, boxes on a grid (in roundings)");
  for (int i = 0; i < test::effort(200); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(840'000 + i));
    const auto cell = [&] { return 0.25 * (static_cast<int>(random() % 17) - 8); };
    const auto size = [&] { return 0.25 * (1 + static_cast<int>(random() % 6)); };
    Case c;
    c.a = testing::solid(testing::box_mesh({size(), size(), size()}));
    c.b = testing::solid(refined(testing::box_mesh({size(), size(), size()})));
    c.motion_a = still_motion(testing::shift(cell(), cell(), cell()));
    c.motion_b = still_motion({});
    compare(grid, c, "grid " + std::to_string(i), found);
  }
}

// The check can fail: a distance that is off by a thousand roundings, a foot moved aside.
TEST(Distance, JudgeSeesPlantedFaults) {
  CcdScratch scratch;
  for (std::uint64_t seed = 850'000; seed < 850'020; ++seed) {
    const Case c = still_case(seed);
    Oracle oracle(c);
    const Real gap = oracle.gap_mm(0.0, 1e30L);
    if (!(gap > 0)) continue;
    DistanceResult d = distance(*c.a, c.motion_a.X_W0, *c.b, c.motion_b.X_W0, scratch);
    EXPECT_LE(error_of(c, d, gap), oracle.rounding_mm());
    d.distance_mm += 1000.0 * oracle.rounding_mm();
    EXPECT_GT(error_of(c, d, gap), oracle.rounding_mm());
    d.distance_mm -= 1000.0 * oracle.rounding_mm();
    d.point_b_W.y() += 1e-9;
    EXPECT_GT(error_of(c, d, gap), oracle.rounding_mm());
  }
}

}  // namespace
}  // namespace mortise::stress
