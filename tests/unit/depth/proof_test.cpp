// What a proof excludes is not there: shapes on which one step of it was too bold.
#include "common/depth/search/proof.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/signed_distance.h"
#include "common/math/rotation.h"
#include "tests/support/numbers.h"
#include "tests/unit/depth/depth_bands.h"

namespace mortise {
namespace {

struct Asked {
  Patch patch;
  bool proven = false;
  double deepest_mm = -1e9;  ///< of the patch's corners
};

Asked ask(const Body& s, std::uint32_t t, const Pose& X, const Body& k, Layer layer,
          double limit_mm) {
  const TriangleMesh& mesh = *s.mesh;
  Asked asked;
  asked.patch =
      make_patch(s, layer, {{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}, t}, X);
  DepthProof proof;
  proof.s = &s;
  proof.k = &k;
  proof.triangle_s = t;
  proof.layer = layer;
  proof.limit_mm = limit_mm;
  proof.rounding_mm = 1e-12;
  proof.at_center = nearest_surface(*k.solid, asked.patch.center);
  ProofScratch scratch;
  asked.proven = depth_at_most(proof, asked.patch, scratch);
  for (int i = 0; i < asked.patch.count; ++i) {
    const Vec3& x = asked.patch.points[i];
    asked.deepest_mm =
        std::max(asked.deepest_mm, k.depth_in(x, nearest_surface(*k.solid, x), layer));
  }
  return asked;
}

// A stepped block: the lower plane is of the same face and as steep as the upper one, and holds
// nothing off the riser.
TEST(Proof, ALowerStepDoesNotCoverTheRiser) {
  const auto k =
      shapes::solid(shapes::prism({{-20, -10}, {20, -10}, {20, 0}, {0, 0}, {0, 10}, {-20, 10}},
                                  {{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}}, -5, 5));
  const auto s = shapes::solid(shapes::box({2, 1, 2}, {1.0, 1.05, 0}));
  const SurfaceBand of_k = shapes::uniform_band({0.0, 0.0}, {-0.1, 0.1}),
                    of_s = shapes::uniform_band({0.0, 0.0}, {0.0, 0.0});
  const Body body_k(*k, of_k), body_s(*s, of_s);
  ASSERT_GT(nearest_surface(*k, Vec3(-0.9, 0.05, 0.0)).depth_mm, 0.5) << "one end of it is inside";
  int asked = 0;
  for (std::uint32_t t = 0; t < s->mesh().triangles.size(); ++t) {
    if (body_s.normal(t).y() > -0.9) continue;
    const Asked one = ask(body_s, t, Pose(), body_k, Layer::kLower, 1e-6);
    ++asked;
    EXPECT_FALSE(one.proven) << t;
  }
  EXPECT_EQ(asked, 2);
}

// A slab whose diagonal side is far off: nothing leaves the block by it.
TEST(Proof, AFarFacetIsNoSecondWall) {
  const auto k = shapes::solid(
      shapes::together(shapes::box({5, 5, 5}, {11.5, 11.5, -5}),
                       shapes::prism({{0, 0}, {9, 0}, {0, 9}}, {{0, 1, 2}}, -1.0, -0.5)));
  const auto s = shapes::solid(shapes::box({0.1, 0.3, 0.5}, {0, 0, 0}));
  const SurfaceBand band = nominal_band();
  const Body body_k(*k, band), body_s(*s, band);
  const Pose X{rotation_exp(Vec3(0, 0, -0.25 * 3.14159265358979323846)), Vec3(8, 8, -0.4)};
  for (std::uint32_t t = 0; t < s->mesh().triangles.size(); ++t)
    for (const double limit_mm : {0.55, 0.6, 0.7, 0.8}) {
      const Asked one = ask(body_s, t, X, body_k, Layer::kMesh, limit_mm);
      EXPECT_FALSE(one.proven && one.deepest_mm > limit_mm + 1e-9)
          << t << " at " << limit_mm << ", corner " << one.deepest_mm;
    }
}

// A slot with a round end: its straight walls may stand 0.1 mm farther in, and so may the face that
// ends on them; what is inside of the round end's cylinder then is no rim's.
TEST(Proof, AThirdFaceThatMovesOutwardLeavesNoRim) {
  constexpr int kN = 16;
  std::vector<std::array<double, 2>> points = {{-10, -10}, {10, -10}, {10, 10}, {5, 10}};
  for (int i = 0; i <= kN; ++i)
    points.push_back({5 * std::cos(-kPi * i / kN), 5 * std::sin(-kPi * i / kN)});
  points.push_back({-5, 10});
  points.push_back({-10, 10});
  const std::uint32_t first = 4, last = first + kN, left = last + 1;
  std::vector<std::array<std::uint32_t, 3>> triangles = {{1, 2, first}, {2, 3, first}};
  for (std::uint32_t i = 0; i < kN / 2; ++i) triangles.push_back({1, first + i, first + i + 1});
  triangles.push_back({0, 1, first + kN / 2});
  for (std::uint32_t i = kN / 2; i < kN; ++i) triangles.push_back({0, first + i, first + i + 1});
  triangles.push_back({0, last, left + 1});
  triangles.push_back({last, left, left + 1});
  const auto slot = shapes::solid(shapes::prism(points, triangles, -5, 0));
  const TriangleMesh& mesh = slot->mesh();
  Surface round;
  round.kind = SurfaceKind::kCylinder;
  round.inward = true;
  round.radius_mm = 5.0;
  for (const double widens_mm : {0.1, 0.0}) {
    SurfaceBand band = shapes::uniform_band({0.0, 0.0}, {-0.1, widens_mm});
    band.faces.resize(2);
    band.faces[1].surface = round;
    band.faces[1].deviation_mm = {-0.03, 0.0};
    band.faces[1].grade = DeviationGrade::kDeclaredFeature;
    band.face_of_triangle = std::vector<std::uint16_t>(mesh.triangles.size(), 0);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      bool on = true;
      for (int k = 0; k < 3; ++k) on &= std::fabs(mesh.corner(t, k).head<2>().norm() - 5.0) < 1e-9;
      if (on) band.face_of_triangle.set(t, 1);
    }
    const Body body(*slot, band);
    int beside_wall = 0, with_rim = 0;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (body.normal(t).z() < 0.9) continue;
      bool wall = false;
      for (const std::uint32_t n : body.sharp_neighbours(t))
        wall |= band.face_of_triangle[n] == 0 && std::fabs(body.normal(n).z()) < 0.1;
      if (!wall) continue;
      ++beside_wall;
      with_rim += make_patch(body, Layer::kUpper,
                             {{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}, t}, Pose())
                      .rim_count;
    }
    EXPECT_GT(beside_wall, 0);
    if (widens_mm > 0.0)
      EXPECT_EQ(with_rim, 0);
    else
      EXPECT_GT(with_rim, 0) << "the test would see nothing";
  }
}

}  // namespace
}  // namespace mortise
