// Convex pieces within a part, and what they show of the depth of a pair.
#include "common/depth/gpd/inner_piece.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/depth/gpd/hull_depth.h"
#include "common/depth/gpd/separation_search.h"
#include "common/geometry/signed_distance.h"
#include "tests/support/effort.h"
#include "tests/support/shapes.h"

namespace mortise {
namespace {

TriangleMesh angle_bracket() {
  return shapes::prism({{0, 0}, {30, 0}, {30, 20}, {20, 20}, {20, 8}, {0, 8}},
                       {{0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}}, 0.0, 12.0);
}

// No point of a piece is outside of its part: asked of random points of its hull.
TEST(InnerPieces, LieWithinTheirPart) {
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> unit;
  int pieces = 0;
  for (const SolidPtr& part :
       {shapes::solid(angle_bracket()), shapes::solid(shapes::u_slot(10, 4, 8, 5, 0, 20)),
        shapes::solid(shapes::ring({8, 0, 10, 16, 1, 0.3}, 16)),
        shapes::solid(shapes::sphere(10, {1, 2, 3}, 6)),
        shapes::solid(shapes::together(shapes::peg({3, 0, 20, 12, 1, 0}),
                                       shapes::box({9, 9, 2}, {0, 0, -2})))})
    for (int i = 0; i < test::effort(60); ++i) {
      Vec3 x;
      for (int k = 0; k < 3; ++k)
        x[k] = part->bounds().lo[k] + unit(random) * 2.0 * part->bounds().half()[k];
      const auto piece = gpd::inner_piece(*part, x, 40);
      if (!piece) continue;
      ++pieces;
      EXPECT_GT(signed_distance_mm(*part, x), -20.0);
      EXPECT_LT(signed_distance_mm(*part, x), 0.0) << "a piece around a point outside";
      for (int k = 0; k < 60; ++k) {
        Vec3 in = Vec3::Zero();
        double sum = 0.0;
        for (const Vec3& corner : piece->corners.all()) {
          const double weight = -std::log(unit(random) + 1e-12) * (k % 2 == 0 ? 1.0 : unit(random));
          in += weight * corner;
          sum += weight;
        }
        EXPECT_LT(signed_distance_mm(*part, in / sum), 1e-12);
      }
      for (const Vec3& corner : piece->corners.all())
        EXPECT_LT(signed_distance_mm(*part, corner), 1e-9);
    }
  EXPECT_GT(pieces, 5 * test::effort(60) / 4);
}

TEST(InnerPieces, AnArmIsOnePiece) {
  const SolidPtr part = shapes::solid(angle_bracket());
  const auto piece = gpd::inner_piece(*part, {25, 14, 6}, 16);
  ASSERT_TRUE(piece);
  EXPECT_NEAR(piece->support_mm(Vec3::UnitY()), 20.0, 1e-6);
  EXPECT_NEAR(piece->support_mm(-Vec3::UnitY()), 0.0, 1e-6);
  EXPECT_NEAR(piece->support_mm(-Vec3::UnitX()), -20.0, 1e-6);
  EXPECT_FALSE(gpd::inner_piece(*part, {10, 14, 6}, 16)) << "outside";
  EXPECT_FALSE(gpd::inner_piece(*part, {25, 14, 6}, 3)) << "too few planes";
}

// Two arms that cross: they hold each other by their whole width, which neither the overlap nor
// balls show.
TEST(InnerPieces, ArmsThatCrossAreHeldByTheirWidth) {
  const SolidPtr a = shapes::solid(angle_bracket()), b = shapes::solid(angle_bracket());
  gpd::PiecesQuery query;
  query.a = a.get();
  query.b = b.get();
  // The upper arm of b lies along x through the upper arm of a.
  query.X_WB = {Quat(Eigen::AngleAxisd(-0.5 * std::numbers::pi, Vec3::UnitZ())), {15, 40, 3}};
  const Vec3 points[] = {{25, 14, 8}, {22, 13, 7}};
  query.points_W = points;
  std::uint64_t work = 0;
  const double bound = gpd::lower_bound_by_pieces_mm(query, work);
  EXPECT_GT(work, 0U);
  CcdScratch scratch;
  // What a long search finds is not undercut.
  gpd::SeparationQuery search;
  search.a = a.get();
  search.b = b.get();
  search.X_WB = query.X_WB;
  search.thorough = true;
  search.least_mm = 1.0;
  const gpd::Separation found = gpd::find_separation(search, scratch);
  ASSERT_TRUE(found.found);
  EXPECT_LE(bound, found.length_mm * (1.0 + 1e-9));
  EXPECT_GE(bound, 0.9 * found.length_mm);
}

}  // namespace
}  // namespace mortise
