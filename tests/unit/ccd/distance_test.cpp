// The distance query: against every pair of triangles, its kernels against each other, the plane
// between hulls.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/ccd/distance.h"
#include "common/ccd/hull_gap.h"
#include "common/ccd/kernels/kernels.h"
#include "common/geometry/triangle_distance.h"
#include "tests/support/effort.h"
#include "tests/support/float_traps.h"
#include "tests/support/numbers.h"
#include "tests/unit/ccd/shapes.h"

namespace mortise::testing {
namespace {

Triangle triangle_of(const TriangleMesh& mesh, std::uint32_t t) {
  return {mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
}

double least_of_all(const TriangleMesh& x, const TriangleMesh& y) {
  double best = 1e300;
  for (std::uint32_t i = 0; i < x.triangles.size(); ++i)
    for (std::uint32_t j = 0; j < y.triangles.size(); ++j)
      best = std::min(best, triangle_distance(triangle_of(x, i), triangle_of(y, j)).distance_mm);
  return best;
}

struct Pair {
  const char* name;
  SolidPtr a, b;
  double reach_mm;
};

TriangleMesh needles(std::mt19937_64& random, int count) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  TriangleMesh mesh;
  for (int k = 0; k < count; ++k) {
    const Vec3 at(unit(random), unit(random), unit(random));
    const Vec3 along(unit(random), unit(random), unit(random));
    const auto first = static_cast<std::uint32_t>(mesh.points_mm.size());
    mesh.points_mm.insert(mesh.points_mm.end(),
                          {at, at + along, at + 0.5 * along + 1e-9 * Vec3(1.0, unit(random), 0.0)});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

std::vector<Pair> pairs() {
  std::mt19937_64 random(61);
  TriangleMesh flat = box_mesh({4, 4, 0.1});
  TriangleMesh same = box_mesh({1, 1, 1});
  for (int k = 0; k < 30; ++k) append(same, box_mesh({1, 1, 1}));
  TriangleMesh far_off = sphere_mesh(1.0, 16, 9);
  for (Vec3& x : far_off.points_mm) x += Vec3(1e5, 0, -1e5);
  std::vector<Pair> all;
  all.push_back({"spheres", solid(sphere_mesh(1, 24, 13)), solid(sphere_mesh(2, 20, 11)), 4.0});
  all.push_back(
      {"peg and bore", solid(prism_mesh(0.9, 24, -1, 1)), solid(tube_mesh(1, 2, 24, -3, 3)), 0.05});
  all.push_back({"plate and copies", solid(flat), solid(same), 3.0});
  all.push_back({"needles", solid(needles(random, 150)), solid(needles(random, 150)), 3.0});
  all.push_back({"one triangle", solid(needles(random, 1)), solid(sphere_mesh(1, 12, 7)), 3.0});
  all.push_back({"far from their origins", solid(far_off), solid(far_off), 4.0});
  return all;
}

TEST(DistanceTwin, IsTheLeastOfAllPairsInManyShapes) {
  const test::FloatTraps traps;
  std::mt19937_64 random(62);
  CcdScratch scratch;
  int apart = 0, crossing = 0;
  for (const Pair& pair : pairs())
    for (int i = 0; i < test::effort(20); ++i) {
      const double angle = pair.reach_mm < 0.1 ? 0.02 : kPi;
      Pose X_WA = random_pose(random, pair.reach_mm, angle);
      const Pose X_WB = random_pose(random, 0.0, kPi);
      // Turned about the middle of each mesh, however far that is from its origin.
      X_WA.p = X_WB * (pair.b->bvh().origin + X_WA.p) - X_WB.q * (X_WA.q * pair.a->bvh().origin);
      X_WA.q = (X_WB.q * X_WA.q).normalized();
      const double size = pair.a->bvh().extent_mm + pair.b->bvh().extent_mm + X_WA.p.norm();
      const double rounding_mm = 64.0 * kUnitRoundoff * size;
      const double twin =
          least_of_all(transformed(pair.a->mesh(), X_WA), transformed(pair.b->mesh(), X_WB));
      const DistanceResult d = distance(*pair.a, X_WA, *pair.b, X_WB, scratch);
      ASSERT_TRUE(d.within_limit) << pair.name;
      ASSERT_NEAR(d.distance_mm, twin, rounding_mm) << pair.name << " " << i;
      if (twin <= rounding_mm) {
        EXPECT_TRUE(surfaces_cross(*pair.a, X_WA, *pair.b, X_WB, scratch)) << pair.name;
        ++crossing;
        continue;
      }
      ++apart;
      EXPECT_FALSE(surfaces_cross(*pair.a, X_WA, *pair.b, X_WB, scratch)) << pair.name;
      // The witnesses: that far apart, on the triangles that are named.
      EXPECT_NEAR((d.point_a_W - d.point_b_W).norm(), d.distance_mm, rounding_mm) << pair.name;
      const auto on = [&](const Solid& part, const Pose& X, std::uint32_t t, const Vec3& at_W) {
        const Vec3 x = X.inverse() * at_W;
        return triangle_distance(triangle_of(part.mesh(), t), {x, x, x}).distance_mm;
      };
      const double off_mm = 4.0 * rounding_mm;
      EXPECT_LE(on(*pair.a, X_WA, d.triangle_a, d.point_a_W), off_mm) << pair.name;
      EXPECT_LE(on(*pair.b, X_WB, d.triangle_b, d.point_b_W), off_mm) << pair.name;
      // Limits: below, above.
      const DistanceResult below =
          distance(*pair.a, X_WA, *pair.b, X_WB, scratch, 0.99 * twin - rounding_mm);
      EXPECT_FALSE(below.within_limit) << pair.name;
      EXPECT_EQ(below.distance_mm, 0.99 * twin - rounding_mm);
      const DistanceResult above =
          distance(*pair.a, X_WA, *pair.b, X_WB, scratch, 1.01 * twin + rounding_mm);
      EXPECT_TRUE(above.within_limit) << pair.name;
      EXPECT_NEAR(above.distance_mm, twin, rounding_mm) << pair.name;
      // Either way round.
      EXPECT_NEAR(distance(*pair.b, X_WB, *pair.a, X_WA, scratch).distance_mm, twin, rounding_mm)
          << pair.name;
    }
  EXPECT_GT(apart, 100);
  EXPECT_GT(crossing, 5);
}

// Overlap first and nearest first look at pairs in another order, by another bound.
TEST(SurfacesCross, AgreesWithTheDistance) {
  const test::FloatTraps traps;
  std::mt19937_64 random(67);
  CcdScratch scratch;
  std::vector<Pair> all = pairs();
  all.push_back({"long bars", solid(box_mesh({8, 0.1, 0.2})), solid(box_mesh({0.2, 9, 0.1})), 0.5});
  all.push_back({"plate in a tube", solid(box_mesh({1.9, 1.9, 0.05})),
                 solid(tube_mesh(1.2, 1.4, 48, -1, 1)), 0.5});
  int apart = 0, crossing = 0;
  for (const Pair& pair : all)
    for (int i = 0; i < test::effort(60); ++i) {
      const Pose X = random_pose(random, pair.reach_mm, pair.reach_mm < 0.1 ? 0.02 : kPi);
      const double distance_mm = distance(*pair.a, X, *pair.b, {}, scratch).distance_mm;
      const bool cross = surfaces_cross(*pair.a, X, *pair.b, {}, scratch);
      ASSERT_EQ(cross, distance_mm == 0.0) << pair.name << " " << i;
      EXPECT_EQ(surfaces_cross(*pair.b, {}, *pair.a, X, scratch), cross) << pair.name << " " << i;
      ++(cross ? crossing : apart);
    }
  EXPECT_GT(apart, 100);
  EXPECT_GT(crossing, 100);
}

// Long thin boxes at any angle, against every pair of their triangles.
TEST(BoxKernels, BoundsAreNoMoreThanTheDistanceOfTheBoxes) {
  std::mt19937_64 random(68);
  std::uniform_real_distribution<double> size(0.02, 3.0);
  int close = 0;
  for (int n = 0; n < test::effort(400); ++n) {
    const Vec3 half_a(size(random), 0.1 * size(random), 0.1 * size(random));
    const Vec3 half_b(0.1 * size(random), size(random), 0.1 * size(random));
    const SolidPtr a = solid(box_mesh(2.0 * half_a)), b = solid(box_mesh(2.0 * half_b));
    const Pose X = random_pose(random, 2.0, kPi);
    const double distance_mm = least_of_all(transformed(a->mesh(), X), b->mesh());
    ccd::PairMotion motion(*a, still_motion(X), *b, still_motion({}));
    motion.at(0.0);
    const auto axes = [](const SolidPtr& s) {
      return ccd::BoxAxes{nullptr, Vec3::Zero(), s->bvh().radius_mm};
    };
    const ccd::BoxFrame& frame = motion.still_frame(axes(a), axes(b));
    float center[3][8] = {}, half[3][8];
    ccd::OneBox one{};
    for (int c = 0; c < 3; ++c) {
      std::fill(half[c], half[c] + 8, static_cast<float>(half_a[c]));
      one.half[c] = static_cast<float>(half_b[c]);
    }
    alignas(32) float lower[8], apart[8];
    ccd::best_kernels().box.lower_a(frame, {center, half}, one, lower);
    ccd::best_kernels().box.apart_a(frame, {center, half}, one, apart);
    // The halves were rounded to float.
    EXPECT_LE(static_cast<double>(lower[5]), distance_mm + 1e-6) << n;
    EXPECT_LE(static_cast<double>(apart[5]), distance_mm + 1e-6) << n;
    if (distance_mm == 0.0) continue;
    EXPECT_GT(apart[5], -1e-4F) << n << ": of two boxes one of the fifteen axes shows the gap";
    close += static_cast<double>(lower[5]) > 0.5 * distance_mm;
  }
  EXPECT_GT(close, 100) << "a bound of nothing is no bound";
}

// Ticks of a slow motion, each seeded with the answer of the one before; then seeds that are wrong.
TEST(DistanceSeed, ChangesNoDistance) {
  const test::FloatTraps traps;
  std::mt19937_64 random(66);
  CcdScratch scratch;
  std::vector<Pair> all = pairs();
  all.push_back(
      {"fine spheres", solid(sphere_mesh(1, 80, 41)), solid(sphere_mesh(2, 80, 41)), 3.5});
  int told = 0;
  for (const Pair& pair : all)
    for (int i = 0; i < test::effort(6); ++i) {
      Pose X = random_pose(random, pair.reach_mm, pair.reach_mm < 0.1 ? 0.02 : kPi);
      const Pose step = random_pose(random, 0.005, 0.005);
      const Vec3 shift = pair.b->bvh().origin - X.q * pair.a->bvh().origin;
      X.p += shift;
      DistanceResult seed;
      for (int tick = 0; tick < 8; ++tick) {
        X = {(step.q * X.q).normalized(), X.p + step.p};
        const DistanceResult fresh = distance(*pair.a, X, *pair.b, {}, scratch);
        const double any = std::numeric_limits<double>::infinity();
        const DistanceResult seeded = distance(*pair.a, X, *pair.b, {}, scratch, any, &seed);
        EXPECT_EQ(seeded.distance_mm, fresh.distance_mm) << pair.name;
        EXPECT_EQ(seeded.within_limit, fresh.within_limit);
        told += seed.within_limit;
        seed = seeded;
        DistanceResult wrong = fresh;
        wrong.triangle_a = static_cast<std::uint32_t>(random() % 20'000);
        wrong.triangle_b = static_cast<std::uint32_t>(random() % 2'000);
        wrong.distance_mm = std::numeric_limits<double>::quiet_NaN();
        EXPECT_EQ(distance(*pair.a, X, *pair.b, {}, scratch, any, &wrong).distance_mm,
                  fresh.distance_mm)
            << pair.name;
        const double limit_mm = 0.5 * fresh.distance_mm;
        if (fresh.distance_mm > 0.0) {
          EXPECT_FALSE(distance(*pair.a, X, *pair.b, {}, scratch, limit_mm, &seed).within_limit);
        }
      }
    }
  EXPECT_GT(told, 200);
}

ccd::FourTriangles four(std::mt19937_64& random, const Vec3& at, double size_mm) {
  std::normal_distribution<double> normal;
  ccd::FourTriangles t;
  for (int i = 0; i < 4; ++i) {
    const double flat = i == 3 ? 1e-9 : 1.0;  // a sliver
    for (int k = 0; k < 3; ++k)
      for (int c = 0; c < 3; ++c)
        t.corner[k][c][i] = at[c] + size_mm * normal(random) * (k == 2 ? flat : 1.0);
  }
  return t;
}

Triangle lane(const ccd::FourTriangles& t, int i) {
  Triangle out;
  for (int k = 0; k < 3; ++k)
    out[k] = Vec3(t.corner[k][0][i], t.corner[k][1][i], t.corner[k][2][i]);
  return out;
}

// `shrink` plants a fault: the kernel is given a shorter reach than it is judged by.
int wrongly_discarded(double shrink, int& discarded, int& kept) {
  std::mt19937_64 random(63);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int wrong = 0;
  discarded = kept = 0;
  for (int n = 0; n < test::effort(3000); ++n) {
    const Pose at = random_pose(random, 6.0, kPi);
    const ccd::FourTriangles a = four(random, Vec3::Zero(), 1.0), b = four(random, at.p, 1.0);
    double d[4][4];
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) d[i][j] = triangle_distance(lane(a, i), lane(b, j)).distance_mm;
    ccd::Reach reach;
    const double judged = d[n % 4][n / 4 % 4] * (1.0 + 1e-12) + 1e-13;
    reach.mm = shrink * judged;
    const Vec3 direction = at.p.normalized();
    if (n % 3 != 0)
      for (int c = 0; c < 3; ++c) reach.n[c] = direction[c];
    const unsigned near = ccd::best_kernels().discard.near_pairs(a, b, reach);
    const unsigned along = ccd::best_kernels().discard.near_along(a, b, reach);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const unsigned bit = 1U << (4 * i + j);
        discarded += (near & bit) == 0;
        kept += (near & bit) != 0;
        if (d[i][j] <= judged) wrong += (near & bit) == 0 || (along & bit) == 0;
      }
  }
  return wrong;
}

TEST(DiscardKernels, NeverDiscardWhatIsWithinReach) {
  const test::FloatTraps traps;
  int discarded = 0, kept = 0;
  EXPECT_EQ(wrongly_discarded(1.0, discarded, kept), 0);
  EXPECT_GT(discarded, 5000);
  EXPECT_GT(kept, 5000);
  EXPECT_GT(wrongly_discarded(0.9, discarded, kept), 100) << "the check must be able to fail";
}

TEST(DiscardKernels, WideAndPortableAgreeToTheLastBit) {
  const test::FloatTraps traps;
  if (ccd::wide_kernels() == nullptr)
    GTEST_SKIP() << "machine: no AVX2, the portable kernels are the only ones";
  const ccd::DiscardKernels& wide = ccd::wide_kernels()->discard;
  const ccd::DiscardKernels& portable = ccd::portable_kernels().discard;
  std::mt19937_64 random(64);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int n = 0; n < 2000; ++n) {
    const Pose at = random_pose(random, 5.0, kPi);
    double corners[36];
    for (double& x : corners) x = unit(random);
    ccd::Placement placement;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) placement.r[i][j] = at.rotation()(i, j);
      placement.p[i] = at.p[i];
      placement.origin[i] = unit(random);
    }
    ccd::FourTriangles a, b, twin;
    wide.place(corners, 1 + n % 4, placement, a);
    portable.place(corners, 1 + n % 4, placement, twin);
    EXPECT_EQ(std::memcmp(&a, &twin, sizeof a), 0);
    wide.move(corners, 1 + n % 4, placement.origin, b);
    portable.move(corners, 1 + n % 4, placement.origin, twin);
    EXPECT_EQ(std::memcmp(&b, &twin, sizeof b), 0);
    const ccd::Reach reach{3.0 * std::abs(unit(random)), {at.p.x() / 9, at.p.y() / 9, 0.1}};
    EXPECT_EQ(wide.near_pairs(a, b, reach), portable.near_pairs(a, b, reach));
    EXPECT_EQ(wide.near_along(a, b, reach), portable.near_along(a, b, reach));
  }
}

// A needle so thin that the square of its normal is lost is still 5 mm away.
TEST(DiscardKernels, ANormalWhoseSquareIsLostDiscardsNothing) {
  const test::FloatTraps traps;
  const auto triangle = [](double e, double z) {
    TriangleMesh mesh;
    mesh.points_mm = {Vec3(-1, -e, z), Vec3(1, -e, z), Vec3(0, e, z)};
    mesh.triangles = {{0, 1, 2}};
    return solid(mesh);
  };
  CcdScratch scratch;
  for (const double e : {1e-20, 1e-100, 3e-163, 1e-300}) {
    const DistanceResult d =
        distance(*triangle(e, 0.0), Pose{}, *triangle(1.0, 5.0), Pose{}, scratch, 1000.0);
    EXPECT_TRUE(d.within_limit) << e;
    EXPECT_NEAR(d.distance_mm, 5.0, 1e-13) << e;
  }
}

TEST(HullGap, IsTheDistanceOfConvexPartsAndItsPlaneHoldsForAllCorners) {
  const test::FloatTraps traps;
  std::mt19937_64 random(65);
  int apart = 0, overlapping = 0;
  for (int n = 0; n < test::effort(100); ++n) {
    const SolidPtr a = solid(convex_mesh(random, 20)), b = solid(sphere_mesh(1, 14, 8));
    const Pose X_WA = random_pose(random, 2.0, kPi);
    ccd::PairMotion motion(*a, still_motion(X_WA), *b, still_motion({}));
    const ccd::PairState& s = motion.at(0.0);
    const ccd::HullGap gap = ccd::hull_gap(motion, a->bvh(), b->bvh(), -s.p);
    const double twin = least_of_all(transformed(a->mesh(), X_WA), b->mesh());
    if (!gap.apart) {
      ++overlapping;
      EXPECT_LE(twin, 1e-12) << "convex parts that are apart have a plane between them";
      continue;
    }
    ++apart;
    // A bound; below by no more than single precision of both parts.
    EXPECT_LE(gap.gap_mm, twin + 1e-13);
    EXPECT_GE(gap.gap_mm, twin - 4e-6 * (a->bvh().radius_mm + b->bvh().radius_mm) - 1e-12);
    for (const Vec3& x : a->mesh().points_mm)
      EXPECT_LE(gap.n.dot(X_WA * x - b->bvh().origin), gap.far_a_mm + 1e-14);
    for (const Vec3& y : b->mesh().points_mm)
      EXPECT_GE(gap.n.dot(y - b->bvh().origin), gap.near_b_mm - 1e-14);
    // Leaves above a height: all of them, and none besides.
    const double floor_mm = 0.3;
    ccd::LeafList list;
    ASSERT_TRUE(ccd::leaves_above(b->bvh(), gap.n, floor_mm, list));
    int expected = 0;
    for (const Bvh::Leaf& leaf : b->bvh().leaves) {
      bool above = false;
      for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i)
        for (int k = 0; k < 3; ++k) {
          const Vec3& y = b->mesh().corner(b->bvh().triangle_order[i], k);
          above = above || gap.n.dot(y - b->bvh().origin) > floor_mm;
        }
      expected += above;
    }
    EXPECT_EQ(list.count, expected);
  }
  EXPECT_GT(apart, 25);
  EXPECT_GT(overlapping, 5);
}

}  // namespace
}  // namespace mortise::testing
