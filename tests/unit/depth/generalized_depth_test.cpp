#include "common/ccd/distance.h"
#include "common/depth/depth.h"
#include "common/depth/gpd/separation_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "tests/unit/depth/depth_bands.h"

namespace mortise {
namespace {

using namespace shapes;

struct MovedPair {
  SolidPtr a, b;
  Motion motion_a = still_motion(Pose()), motion_b = still_motion(Pose());
  double t_contact = 1.0;
  SurfaceBand band_a = nominal_band(), band_b = nominal_band();
  bool b_moves = false;
  Refinement refinement = Refinement::kFull;
};

struct Told {
  GeneralizedDepth depth;
  TravelSinceContact travel;
};

Told tell(const MovedPair& s, OverlapResult* overlap = nullptr) {
  GpdQuery query;
  query.overlap.a = s.a.get();
  query.overlap.b = s.b.get();
  query.overlap.band_a = &s.band_a;
  query.overlap.band_b = &s.band_b;
  query.overlap.X_WA = s.motion_a.X_W1;
  query.overlap.X_WB = s.motion_b.X_W1;
  query.overlap.refinement = s.refinement;
  query.motion_a = s.motion_a;
  query.motion_b = s.motion_b;
  query.t_contact = s.t_contact;
  CcdScratch scratch;
  const OverlapResult result = find_overlap(query.overlap, scratch);
  if (overlap != nullptr) *overlap = result;
  if (result.regions.empty()) return {};
  query.regions = result.regions;
  query.b_moves = s.b_moves;
  return {generalized_depth(query, scratch),
          travel_since_contact(result.regions[0], query.motion_a, query.motion_b, query.t_contact)};
}

GeneralizedDepth depth_of(const MovedPair& s, OverlapResult* overlap = nullptr) {
  return tell(s, overlap).depth;
}

// The motion as it is told frees the parts, and its longest path is the depth: asked of the motion
// point by point, at its end and by small steps.
void expect_parts(const MovedPair& s, const GeneralizedDepth& depth) {
  CcdScratch scratch;
  const SeparatingMotion& motion = depth.motion;
  const Solid& mover = motion.of_b ? *s.b : *s.a;
  const Pose X = motion.of_b ? s.motion_b.X_W1 : s.motion_a.X_W1;
  const Pose X_end = motion.displacement() * X;
  EXPECT_TRUE(motion.of_b ? gpd::is_apart(*s.a, s.motion_a.X_W1, *s.b, X_end, scratch)
                          : gpd::is_apart(*s.a, X_end, *s.b, s.motion_b.X_W1, scratch));
  const Motion screw = motion.rotation_rad.isZero(0.0)
                           ? linear_motion(X, X_end, mover.sphere().center_mm)
                           : screw_motion(X, X_end, mover.sphere().center_mm);
  double longest = 0.0;
  for (const Vec3& x : mover.mesh().points_mm) {
    double path = 0.0;
    for (int i = 0; i < 400; ++i)
      path += (screw.pose_at((i + 1) / 400.0) * x - screw.pose_at(i / 400.0) * x).norm();
    longest = std::max(longest, path);
  }
  EXPECT_NEAR(depth.gpd_mm.hi, longest, 1e-5 * longest + 1e-9);
  EXPECT_NEAR(longest_path_mm(mover, X, motion), depth.gpd_mm.hi, 1e-8 * longest + 1e-9);
}

TEST(GeneralizedDepth, CubesComeApartAlongTheNormal) {
  const GeneralizedDepth gpd =
      depth_of({solid(box({.5, .5, .5})), solid(box({.5, .5, .5}, {.9, .13, .07}))});
  EXPECT_NEAR(gpd.gpd_mm.lo, 0.1, 1e-9);
  EXPECT_NEAR(gpd.gpd_mm.hi, 0.1, 2e-7);
  EXPECT_EQ(gpd.way, SeparationWay::kNormal);
  EXPECT_NEAR(gpd.motion.translation_mm.normalized().x(), -1.0, 1e-6);
}

// A sphere of radius 1 sinks 0.3 below a plane, coming at 60 degrees from its normal.
TEST(GeneralizedDepth, SphereComesInAtSixtyDegrees) {
  MovedPair s{solid(sphere(1, Vec3::Zero(), 32)), solid(box({10, 10, 2}, {0, 0, -2}))};
  const Vec3 end(0, 0, 0.7);
  const Vec3 way = Vec3(std::sin(std::numbers::pi / 3), 0, -std::cos(std::numbers::pi / 3));
  s.motion_a =
      linear_motion(Pose::translation(end - 1.0 * way), Pose::translation(end), Vec3::Zero());
  s.t_contact = 0.4;  // 0.6 mm before the end the lowest point meets the plane
  OverlapResult overlap;
  const auto [gpd, travel] = tell(s, &overlap);
  ASSERT_FALSE(overlap.regions.empty());
  EXPECT_NEAR(overlap.regions[0].delta_mm.lo, 0.3, 1e-9);
  EXPECT_NEAR(travel.path_mm, 0.6, 1e-9);
  EXPECT_NEAR(travel.normal_mm, 0.3, 1e-9);
  EXPECT_NEAR(gpd.gpd_mm.lo, 0.3, 1e-9);
  EXPECT_NEAR(gpd.gpd_mm.hi, 0.3, 1e-6);
}

// A turn by 0.1 rad at 10 mm is a path of 1 mm, its chord 0.99958.
TEST(GeneralizedDepth, PathOfATurn) {
  MovedPair s{solid(box({10, .5, .5})), solid(box({.5, .5, .5}, {9.5, 1.2, 0}))};
  s.motion_a = linear_motion(Pose(), Pose{rotation_exp({0, 0, 0.1}), Vec3::Zero()}, Vec3::Zero());
  s.t_contact = 0.0;
  OverlapResult overlap;
  const auto [gpd, travel] = tell(s, &overlap);
  ASSERT_FALSE(overlap.regions.empty());
  double farthest = 0.0;
  for (const Vec3& x : overlap.regions[0].points_W)
    farthest = std::max(farthest, Vec3(x.x(), x.y(), 0).norm());
  EXPECT_NEAR(travel.path_mm, 0.1 * farthest, 1e-6);
  EXPECT_GT(travel.path_mm, 2.0 * std::sin(0.05) * farthest + 1e-4);
}

// Is some translation of A this long at most enough? Asked in many directions.
bool a_translation_frees(const MovedPair& s, double length_mm) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 400; ++i) {
    Vec3 d = i < 6 ? Vec3((i < 3 ? 1.0 : -1.0) * Vec3::Unit(i % 3))
                   : Vec3(normal(random), normal(random), normal(random)).normalized();
    for (const double share : {1.0, 0.5, 0.25}) {
      MovedPair moved = s;
      moved.motion_a = still_motion(Pose::translation(share * length_mm * d) * s.motion_a.X_W1);
      CcdScratch scratch;
      if (!surfaces_cross(*s.a, moved.motion_a.X_W1, *s.b, s.motion_b.X_W1, scratch)) return true;
    }
  }
  return false;
}

// A key turned in its slot by 0.02 jams between the walls. A turn back by as much, 11 mm
// from its centre at most, frees it; a translation has to lift it out of the slot by 8 mm.
TEST(GeneralizedDepth, ATurnFreesTheKeyOfASlotSooner) {
  MovedPair s{solid(box({3.98, 3, 10})), solid(u_slot(10, 4, 8, 5, 0, 30))};
  s.motion_a = still_motion({rotation_exp({0, 0, 0.02}), {0, 3.3, 15}});
  OverlapResult overlap;
  const GeneralizedDepth gpd = depth_of(s, &overlap);
  ASSERT_FALSE(overlap.regions.empty());
  EXPECT_GT(gpd.gpd_mm.lo, 0.0);
  EXPECT_EQ(gpd.way, SeparationWay::kFitted);
  EXPECT_LT(gpd.gpd_mm.hi, 0.02 * 12);
  EXPECT_FALSE(a_translation_frees(s, 4.0));
  EXPECT_TRUE(a_translation_frees(s, 9.0));
}

// A peg of 20 mm stands 15 mm deep in a plate of 20: out is 15 mm up, or 25 down. Its radius is too
// large by 10 um, so that neither the normal nor a small turn frees it.
struct Standing {
  explicit Standing(double into_mm) {
    scene.a = solid(peg({10.01, 0, 20, 32, 1, 0}));
    scene.b = solid(ring({10, 0, 20, 32, 1, 0}, 20));
    scene.motion_a = still_motion(Pose::translation({0, 0, 20 - into_mm}));
  }
  MovedPair scene;
};

TEST(GeneralizedDepth, APegComesOutAlongItsAxis) {
  MovedPair s = Standing(15).scene;
  for (const bool declared : {false, true}) {
    if (declared) {
      s.band_a = cylinder_band(s.a, 10.01, false, {});
      s.band_b = cylinder_band(s.b, 10, true, {});
    }
    const GeneralizedDepth gpd = depth_of(s);
    EXPECT_EQ(gpd.way, SeparationWay::kAxis) << declared;
    EXPECT_NEAR(gpd.gpd_mm.hi, 15.0, 2e-4) << declared;
    EXPECT_NEAR(gpd.motion.translation_mm.z(), 15.0, 2e-4) << declared;
    // Walls that press from all sides hold it far tighter than they are deep.
    EXPECT_GT(gpd.gpd_mm.lo, 7 * 0.01) << declared;
    expect_parts(s, gpd);
  }
}

TEST(GeneralizedDepth, TheShorterWayAlongTheAxisAnywhereInTheWorld) {
  std::mt19937_64 random(8);
  for (const double into : {4.0, 30.0}) {  // 30: its foot 10 below the plate, 10 mm to go that way
    MovedPair s = Standing(into).scene;
    const Pose G = random_pose(random, 50.0);
    s.motion_b = still_motion(G);
    s.motion_a = still_motion(G * s.motion_a.X_W1);
    const GeneralizedDepth gpd = depth_of(s);
    EXPECT_EQ(gpd.way, SeparationWay::kAxis);
    EXPECT_NEAR(gpd.gpd_mm.hi, into > 20 ? 10.0 : into, 2e-4);
    EXPECT_NEAR((G.q.conjugate() * gpd.motion.translation_mm).z(), into > 20 ? -10.0 : 4.0, 2e-4);
  }
}

// A slack peg that leans in its bore comes free by a small turn and shift, however many facets
// stand for it: no motion of less than 0.199 mm does.
TEST(GeneralizedDepth, ALeaningPegIsTurnedBack) {
  struct Cut {
    int facets, rows;
  };
  for (const auto& [facets, rows] :
       {Cut{24, 3}, Cut{48, 3}, Cut{96, 3}, Cut{200, 3}, Cut{400, 24}}) {
    MovedPair s{solid(peg({9.95, 0, 40, facets, rows, 0})),
                solid(ring({10, 0, 20, facets, (rows + 1) / 2, 0}, 20))};
    s.motion_a = still_motion({rotation_exp({0.01, 0, 0}), {0, 0, -5}});
    s.refinement = Refinement::kDecided;
    const GeneralizedDepth gpd = depth_of(s);
    EXPECT_GT(gpd.gpd_mm.lo, 0.197) << facets;
    EXPECT_LT(gpd.gpd_mm.hi, facets < 100 ? 0.281 : 0.3) << facets;
    EXPECT_EQ(gpd.way, SeparationWay::kFitted) << facets;
    expect_parts(s, gpd);
  }
}

// A bottom of the hole does not matter when the way out is the way it came.
TEST(GeneralizedDepth, ABlindHoleIsLeftUpwards) {
  MovedPair s = Standing(15).scene;
  s.b = solid(together(ring({10, 0, 20, 32, 1, 0}, 20), box({15, 15, 1}, {0, 0, -2})));
  const GeneralizedDepth gpd = depth_of(s);
  EXPECT_EQ(gpd.way, SeparationWay::kAxis);
  EXPECT_NEAR(gpd.motion.translation_mm.z(), 15.0, 2e-4);
}

// Where only the zones meet, the meshes are free as they are.
TEST(GeneralizedDepth, ApartMeansNothingToDo) {
  MovedPair s{solid(box({.5, .5, .5})), solid(box({.5, .5, .5}, {1.02, .1, .2}))};
  s.band_a = s.band_b = uniform_band({}, {-.05, .05});
  const GeneralizedDepth gpd = depth_of(s);
  EXPECT_EQ(gpd.gpd_mm, Interval{});
  EXPECT_EQ(gpd.way, SeparationWay::kNone);
}

// Penetration depth of two boxes in closed form: the faces of their Minkowski difference have the
// normals of either box or are crosses of two edges. For convex bodies turning does not help
// (PD_g = PD_t: Zhang, Kim, Varadhan, Manocha 2007).
double penetration_of_boxes(const Vec3& half_a, const Pose& X_A, const Vec3& half_b,
                            const Pose& X_B) {
  const Mat3 A = X_A.rotation(), B = X_B.rotation();
  std::vector<Vec3> axes;
  for (int i = 0; i < 3; ++i) {
    axes.push_back(A.col(i));
    axes.push_back(B.col(i));
    for (int j = 0; j < 3; ++j) axes.push_back(A.col(i).cross(B.col(j)));
  }
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& axis : axes) {
    if (axis.norm() < 1e-9) continue;
    const Vec3 n = axis.normalized();
    const double reach =
        (A.transpose() * n).cwiseAbs().dot(half_a) + (B.transpose() * n).cwiseAbs().dot(half_b);
    least = std::min(least, reach - std::fabs(n.dot(X_A.p - X_B.p)));
  }
  return least;
}

TEST(GeneralizedDepth, IsThePenetrationOfConvexBodies) {
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> size(0.3, 1.2);
  int asked = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 half_a(size(random), size(random), size(random)),
        half_b(size(random), size(random), size(random));
    MovedPair s{solid(box(half_a, Vec3::Zero(), 1 + i % 3)), solid(box(half_b))};
    Pose X_A = random_pose(random, 0.0), X_B = random_pose(random, 0.0);
    X_A.p = (0.2 + 1.2 * size(random)) * (X_A.q * Vec3::UnitX());
    const double exact = penetration_of_boxes(half_a, X_A, half_b, X_B);
    if (exact < 1e-4) continue;
    s.motion_a = still_motion(X_A);
    s.motion_b = still_motion(X_B);
    s.b_moves = i % 2 == 1;
    s.refinement = i % 4 < 2 ? Refinement::kDecided : Refinement::kFull;
    const GeneralizedDepth gpd = depth_of(s);
    ++asked;
    EXPECT_NEAR(gpd.gpd_mm.lo, exact, 1e-7) << i;
    EXPECT_NEAR(gpd.gpd_mm.hi, exact, 1e-6) << i;
    EXPECT_EQ(gpd.motion.of_b, s.b_moves);
    expect_parts(s, gpd);
  }
  EXPECT_GT(asked, 100);
}

// The motion that is reported really separates, and a shorter one does not.
TEST(GeneralizedDepth, ReportedMotionSeparates) {
  const SolidPtr a = solid(box({.5, .5, .5})), b = solid(box({.5, .5, .5}, {.9, .13, .07}));
  const GeneralizedDepth gpd = depth_of({a, b});
  const auto overlaps_after = [&](double share) {
    MovedPair moved{a, b, still_motion(Pose::translation(share * gpd.motion.translation_mm))};
    OverlapResult overlap;
    depth_of(moved, &overlap);
    return overlap.meshes_cross;
  };
  EXPECT_FALSE(overlaps_after(1.0));
  EXPECT_TRUE(overlaps_after(0.9));
}

}  // namespace
}  // namespace mortise
