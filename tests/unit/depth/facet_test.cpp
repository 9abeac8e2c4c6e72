#include "common/depth/answer/facet.h"

#include <gtest/gtest.h>

#include "common/geometry/signed_distance.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/random_polyhedra.h"

namespace mortise {
namespace {

constexpr double kFlat_mm = 1e-9;

SpaceBox random_box(polyhedra::Random& random, const Vec3& center) {
  SpaceBox box{center, {}};
  const Mat3 axes = polyhedra::rotation(random).toRotationMatrix();
  for (int k = 0; k < 3; ++k)
    box.half[static_cast<std::size_t>(k)] =
        std::pow(10.0, polyhedra::between(random, -3.0, 0.7)) * axes.col(k);
  return box;
}

// Feet of its points on the plane of the triangle, and how far they are off the mesh at most.
double farthest_foot_mm(polyhedra::Random& random, const Solid& solid, std::uint32_t triangle,
                        const SpaceBox& box) {
  const Vec3 n = solid.topology().normal[triangle], a = solid.mesh().corner(triangle, 0);
  double farthest_mm = 0.0;
  for (int i = 0; i < 60; ++i) {
    Vec3 x = box.center;
    // Corners and points between them.
    for (const Vec3& half : box.half)
      x += (i < 8 ? (i >> (&half - box.half.data()) & 1 ? 1.0 : -1.0)
                  : polyhedra::between(random, -1.0, 1.0)) *
           half;
    const Vec3 foot = x - n.dot(x - a) * n;
    farthest_mm = std::max(farthest_mm, (nearest_surface(solid, foot).point - foot).norm());
  }
  return farthest_mm;
}

TEST(Facet, HoldsAFootUnderEveryPointOfABoxThatIsOverIt) {
  polyhedra::Random random(516);
  int over = 0, beside = 0;
  for (int i = 0; i < test::effort(60); ++i) {
    const polyhedra::Polyhedron part =
        i % 2 ? polyhedra::random_boxes(random) : polyhedra::random_convex(random);
    const Solid& solid = *part.solid;
    for (int k = 0; k < 100; ++k) {
      const auto t = static_cast<std::uint32_t>(
          polyhedra::between(random, 0.0, static_cast<double>(solid.mesh().triangles.size())));
      double share[2] = {polyhedra::between(random, 0.0, 1.0),
                         polyhedra::between(random, 0.0, 1.0)};
      if (share[0] + share[1] > 1.0) share[0] = 1.0 - share[0], share[1] = 1.0 - share[1];
      const Vec3 a = solid.mesh().corner(t, 0);
      const SpaceBox box = random_box(
          random, a + share[0] * (solid.mesh().corner(t, 1) - a) +
                      share[1] * (solid.mesh().corner(t, 2) - a) +
                      polyhedra::between(random, -2.0, 2.0) * solid.topology().normal[t]);
      const double off_mm = farthest_foot_mm(random, solid, t, box);
      if (is_over_facet(solid, t, box, kFlat_mm)) {
        ++over;
        EXPECT_LT(off_mm, 1e-8) << i << " " << k;
      } else {
        beside += off_mm > 1e-8;
      }
    }
  }
  EXPECT_GT(over, test::effort(60) * 20);
  EXPECT_GT(beside, test::effort(60) * 20);
}

}  // namespace
}  // namespace mortise
