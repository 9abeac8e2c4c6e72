// What a point's depth below its nearest faces says, beside the drawing of the part.
#include <gtest/gtest.h>

#include "common/depth/body.h"
#include "common/geometry/signed_distance.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/cover_parts.h"

namespace mortise {
namespace {

using cover_parts::Random;
using cover_parts::uniform;

Vec3 direction(Random& random) {
  for (;;) {
    const Vec3 v(uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0),
                 uniform(random, -1.0, 1.0));
    if (v.norm() > 0.1 && v.norm() < 1.0) return v.normalized();
  }
}

// About the surface; two of three about an edge of the mesh.
Vec3 near_surface(Random& random, const TriangleMesh& mesh) {
  const auto t = static_cast<std::uint32_t>(random() % mesh.triangles.size());
  double u = uniform(random, 0.0, 1.0), v = uniform(random, 0.0, 1.0 - u);
  if (random() % 3 != 0) v = 0.0;
  const int k = static_cast<int>(random() % 3);
  const Vec3 on = (1.0 - u - v) * mesh.corner(t, k) + u * mesh.corner(t, (k + 1) % 3) +
                  v * mesh.corner(t, (k + 2) % 3);
  return on + std::exp(uniform(random, std::log(1e-4), std::log(0.2))) * direction(random);
}

void widen(cover_parts::DrawnPart& part, double times) {
  for (auto& [name, offset] : part.offsets) offset = {times * offset.lo, times * offset.hi};
  for (SurfaceBand::Face& face : part.band.faces)
    face.tolerance_mm = {times * face.tolerance_mm.lo, times * face.tolerance_mm.hi};
}

double depth_in(const Body& body, const Vec3& x, Layer layer) {
  return body.depth_in(x, nearest_surface(*body.solid, x), layer);
}

TEST(BodyDepth, WhatIsInsideIsInsideOfTheDrawingToo) {
  constexpr double kNothing_mm = 1e-6;
  Random random(5);
  long long inside = 0;
  for (int i = 0; i < test::effort(60); ++i) {
    cover_parts::DrawnPart part = cover_parts::any_part(random, uniform(random, 3.0, 12.0));
    widen(part, i % 3 == 0 ? 1.0 : 5.0);
    const Body body(*part.solid, part.band);
    // Behind a hollow edge less is said than is true.
    const bool hollow = part.what != "ring" && part.what != "plate" && part.what != "block";
    for (int j = 0; j < 1500; ++j) {
      const Vec3 x = near_surface(random, part.solid->mesh());
      for (const bool largest : {false, true}) {
        const double said = depth_in(body, x, largest ? Layer::kUpper : Layer::kLower);
        const double drawn = part.depth_in(x, largest);
        EXPECT_FALSE(said > kNothing_mm && drawn < -kNothing_mm)
            << part.what << " " << i << " point " << x.transpose() << ", largest " << largest
            << ": said " << said << ", drawn " << drawn;
        if (hollow || drawn < kNothing_mm) continue;
        ++inside;
        EXPECT_GT(said, 0.0) << part.what << " " << i << " point " << x.transpose() << ", largest "
                             << largest << ": drawn " << drawn;
      }
    }
  }
  EXPECT_GT(inside, test::effort(60) * 100);
}

// A chamfer that is cut deeper than it is drawn ends farther up the shaft, where the mesh has no
// facet of it, and where the facets of the shaft are below its surface.
TEST(BodyDepth, AMovedChamferGoesOnBeyondItsFacets) {
  constexpr double kR_mm = 3.0, kChamfer_mm = 0.6, kDeeper_mm = 0.07;
  const auto shaft = generate(
      "shaft",
      {{"d1_mm", 2.0 * kR_mm}, {"l1_mm", 10.0}, {"chamfer_mm", kChamfer_mm}, {"facets", 32}});
  ASSERT_TRUE(shaft);
  const Solid solid(shaft->mesh);
  BandInput input;
  input.solid = &solid;
  input.features = shaft->features;
  for (const Feature& feature : shaft->features)
    input.of_feature.push_back(
        {feature.name == "chamfer_lower" ? Interval{-kDeeper_mm, 0.0} : Interval{}, "drawn"});
  const SurfaceBand band = build_band(input);
  const Body body(solid, band);
  const double end_mm = kChamfer_mm + std::numbers::sqrt2 * kDeeper_mm;
  for (int i = 0; i < 64; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i + 0.5) / 64.0;
    const auto at = [&](double r_mm, double z_mm) {
      return Vec3(r_mm * std::cos(angle), r_mm * std::sin(angle), z_mm);
    };
    for (const double in_mm : {1e-4, 1e-3, 5e-3}) {
      // As far below the chamfer as below the shaft.
      const Vec3 x = at(kR_mm - in_mm, end_mm + (std::numbers::sqrt2 - 1.0) * in_mm);
      EXPECT_NEAR(depth_in(body, x, Layer::kLower), in_mm, 1e-6) << i;
    }
    EXPECT_LT(depth_in(body, at(kR_mm - 1e-4, end_mm - 2e-4), Layer::kLower), 0.0) << i;
  }
}

}  // namespace
}  // namespace mortise
