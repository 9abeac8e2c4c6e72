#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

#include "common/depth/answer/region_report.h"
#include "tests/unit/depth/depth_bands.h"

namespace mortise {
namespace {

using namespace shapes;

// Ring of circular section about z: centre circle R, tube r, n x m facets.
TriangleMesh torus(double R, double r, std::uint32_t n, std::uint32_t m) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j) {
      const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / m;
      mesh.points_mm.push_back(on_circle(R + r * std::cos(v), u, r * std::sin(v)));
    }
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < m; ++j) {
      const std::uint32_t k = (i + 1) % n, l = (j + 1) % m;
      add_quad(mesh, i * m + j, k * m + j, k * m + l, i * m + l);
    }
  return mesh;
}

Vec3 middle_of(const TriangleMesh& mesh, std::uint32_t t) {
  return (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3.0;
}

// How many triangles have each shape, among those that are asked for.
std::map<FaceShape, int> shapes_of(const TriangleMesh& mesh, const SurfaceBand& band,
                                   const std::function<bool(const Vec3&)>& wanted) {
  const SolidPtr part = solid(mesh);
  const Body body(*part, band);
  std::map<FaceShape, int> count;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (const Vec3 x = middle_of(mesh, t); wanted(x)) ++count[face_shape(body, t, x)];
  return count;
}

double from_axis(const Vec3& x) { return std::hypot(x.x(), x.y()); }

using Counts = std::map<FaceShape, int>;

TEST(FaceShape, OfMeshesByTheirEdges) {
  const SurfaceBand nothing = nominal_band();
  for (const int rows : {1, 3}) {
    const TriangleMesh shaft = peg({10, 0, 20, 32, rows, 0.1});
    const auto on_round = [](const Vec3& x) { return from_axis(x) > 9.0; };
    EXPECT_EQ(shapes_of(shaft, nothing, on_round), (Counts{{FaceShape::kConvex, 64 * rows}}));
    EXPECT_EQ(shapes_of(shaft, nothing, [&](const Vec3& x) { return !on_round(x); }),
              (Counts{{FaceShape::kPlanar, 64}}));
    const TriangleMesh plate = ring({10, 0, 20, 32, rows, 0}, 20);
    EXPECT_EQ(shapes_of(plate, nothing, [](const Vec3& x) { return from_axis(x) < 10.01; }),
              (Counts{{FaceShape::kConcave, 64 * rows}}));
  }
  EXPECT_EQ(shapes_of(box({1, 2, 3}, Vec3::Zero(), 3), nothing, [](const Vec3&) { return true; }),
            (Counts{{FaceShape::kPlanar, 108}}));
  EXPECT_EQ(shapes_of(sphere(5), nothing, [](const Vec3&) { return true; }),
            (Counts{{FaceShape::kConvex, 960}}));
}

// Facets that stand for too wide a turn look like planes: nothing tells a prism of eight sides from
// a round one.
TEST(FaceShape, ACoarseRoundIsAPrism) {
  EXPECT_EQ(shapes_of(peg({10, 0, 20, 8, 1, 0}), nominal_band(), [](const Vec3&) { return true; }),
            (Counts{{FaceShape::kPlanar, 32}}));
}

TEST(FaceShape, ATorusIsConvexOutsideAndASaddleInside) {
  const TriangleMesh mesh = torus(20, 5, 64, 32);
  // By its edges: away from the top and bottom circles, where the facets go either way.
  const auto outer = [](const Vec3& x) { return from_axis(x) > 20.6; };
  const auto inner = [](const Vec3& x) { return from_axis(x) < 19.4; };
  const Counts outside = shapes_of(mesh, nominal_band(), outer);
  const Counts inside = shapes_of(mesh, nominal_band(), inner);
  EXPECT_EQ(outside.size(), 1u);
  EXPECT_GT(outside.count(FaceShape::kConvex), 0u);
  EXPECT_EQ(inside.size(), 1u);
  EXPECT_GT(inside.count(FaceShape::kSaddle), 0u);
  // By its surface: on all of it; a groove of that form the other way round.
  SurfaceBand band = nominal_band();
  Surface surface;
  surface.kind = SurfaceKind::kTorus;
  surface.radius_mm = 20;
  surface.tube_radius_mm = 5;
  for (const bool inward : {false, true}) {
    surface.inward = inward;
    band.faces[0].surface = surface;
    const FaceShape away = inward ? FaceShape::kConcave : FaceShape::kConvex;
    EXPECT_EQ(shapes_of(mesh, band, [](const Vec3& x) { return from_axis(x) >= 20; }),
              (Counts{{away, 2048}}));
    EXPECT_EQ(shapes_of(mesh, band, [](const Vec3& x) { return from_axis(x) < 20; }),
              (Counts{{FaceShape::kSaddle, 2048}}));
  }
}

// A region names the shapes where it is decided: a ball on the outside of a ring and in its eye.
TEST(FaceShape, OfARegionAtItsPoint) {
  const SolidPtr ring_part = solid(torus(20, 5, 64, 32)), ball = solid(sphere(2));
  SurfaceBand band = nominal_band();
  Surface surface;
  surface.kind = SurfaceKind::kTorus;
  surface.radius_mm = 20;
  surface.tube_radius_mm = 5;
  band.faces[0].surface = surface;
  band.faces[0].deviation_mm = {-0.2, 0.2};
  band.trivial = false;
  band.largest_offset_mm = 0.2;
  const SurfaceBand nothing = nominal_band();
  for (const double x : {13.2, 26.8}) {
    OverlapQuery query;
    query.a = ball.get();
    query.b = ring_part.get();
    query.band_a = &nothing;
    query.band_b = &band;
    query.X_WA = Pose::translation({x, 0, 0});
    CcdScratch scratch;
    const OverlapResult result = find_overlap(query, scratch);
    ASSERT_FALSE(result.regions.empty()) << x;
    EXPECT_EQ(result.regions[0].shape_a, FaceShape::kConvex) << x;
    EXPECT_EQ(result.regions[0].shape_b, x < 20 ? FaceShape::kSaddle : FaceShape::kConvex) << x;
  }
}

}  // namespace
}  // namespace mortise
