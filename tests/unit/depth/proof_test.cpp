// What a proof excludes is not there: shapes on which one step of it was too bold.
#include "common/depth/search/proof.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/signed_distance.h"
#include "common/math/rotation.h"
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

}  // namespace
}  // namespace mortise
