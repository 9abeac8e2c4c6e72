// A patch holds all of the surface that it stands for, however many faces meet at its triangle.
#include "common/depth/search/patch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/unit/depth/depth_bands.h"

namespace mortise {
namespace {

constexpr int kRing = 9;

// A triangle on top of a ring of nine points: three faces begin at each of its corners and one at
// each of its edges, twelve in all. Each is a face of its own: of a cylinder that touches it at the
// corner, or plane.
struct Crown {
  explicit Crown(bool round) {
    TriangleMesh mesh;
    const auto at = [](double degrees, double radius, double z) {
      const double angle = degrees * std::numbers::pi / 180.0;
      return Vec3(radius * std::cos(angle), radius * std::sin(angle), z);
    };
    for (int i = 0; i < 3; ++i) mesh.points_mm.push_back(at(120.0 * i, 1.0, 0.0));
    for (int j = 0; j < kRing; ++j) mesh.points_mm.push_back(at(40.0 * j - 60.0, 3.0, -4.0));
    mesh.points_mm.push_back(Vec3(0, 0, -4.0));
    const auto ring = [](int j) { return static_cast<std::uint32_t>(3 + (j + kRing) % kRing); };
    mesh.triangles.push_back({0, 1, 2});
    for (std::uint32_t i = 0; i < 3; ++i) {
      const int first = 3 * static_cast<int>(i);
      for (int j = first; j < first + 3; ++j) mesh.triangles.push_back({i, ring(j), ring(j + 1)});
      mesh.triangles.push_back({i, ring(first + 3), (i + 1) % 3});
    }
    for (int j = 0; j < kRing; ++j) mesh.triangles.push_back({12, ring(j + 1), ring(j)});
    solid = shapes::solid(std::move(mesh));
    const TriangleMesh& m = solid->mesh();
    band = shapes::uniform_band({0.0, 0.0}, {-0.2, 0.01});
    band.faces.resize(14, band.faces.front());
    band.face_of_triangle = std::vector<std::uint16_t>(m.triangles.size(), 13);
    for (std::uint16_t t = 0; t < 13; ++t) band.face_of_triangle.set(t, t);
    for (std::uint16_t t = 1; t < 13 && round; ++t) {
      const Vec3 n = (m.corner(t, 1) - m.corner(t, 0)).cross(m.corner(t, 2) - m.corner(t, 0));
      Surface surface;
      surface.kind = SurfaceKind::kCylinder;
      surface.radius_mm = 3.0;
      surface.axis = n.cross(Vec3::UnitZ()).normalized();
      surface.point = m.corner(t, 0) - surface.radius_mm * n.normalized();
      band.faces[t].surface = surface;
    }
  }
  Piece top() const {
    const TriangleMesh& m = solid->mesh();
    return {{m.corner(0, 0), m.corner(0, 1), m.corner(0, 2)}, 0};
  }

  SolidPtr solid;
  SurfaceBand band;
};

TEST(Patch, HoldsAllThatManyNeighboursLeaveOfAFace) {
  const Crown crown(true);
  const Body body(*crown.solid, crown.band);
  ASSERT_GE(body.sharp_neighbours(0).size(), 8u) << "no edge is sharp: nothing is shown";
  const Piece top = crown.top();
  const PieceShape shape = shape_of(body, Layer::kLower, top);
  const Patch still = make_patch(shape, Pose());
  const Patch swept = make_swept_patch(shape, Pose(), Pose::translation({0, 0, 1}), 0.0, 0.0);
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int left = 0;
  for (int i = 0; i < 20'000; ++i) {
    double u = unit(random), v = unit(random);
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    const Vec3 on_mesh = top.corners[0] + u * (top.corners[1] - top.corners[0]) +
                         v * (top.corners[2] - top.corners[0]);
    const Vec3 x = on_mesh - Vec3(0, 0, 0.2);
    bool is_left = true;
    for (const std::uint32_t t : body.sharp_neighbours(0))
      is_left &= body.face(t).surface->signed_distance_mm(x) <= -0.2;
    if (!is_left) continue;
    ++left;
    const Vec3 d = Vec3(normal(random), normal(random), normal(random)).normalized();
    for (const Patch* patch : {&still, &swept}) {
      double farthest = -1e9;
      for (int k = 0; k < patch->count; ++k) farthest = std::max(farthest, d.dot(patch->points[k]));
      ASSERT_GE(farthest, d.dot(x) - 1e-9) << "corners " << shape.polygon.size();
    }
  }
  EXPECT_GT(left, 1'000);
}

TEST(Patch, IsThickenedByEveryNeighbourThatMovesOutward) {
  Crown crown(false);
  for (std::uint16_t t = 9; t < 13; ++t) crown.band.faces[t].tolerance_mm.hi = 0.3;
  const Body body(*crown.solid, crown.band);
  ASSERT_EQ(body.sharp_neighbours(0).size() + body.sharp_left_out(0), 12u);
  ASSERT_GT(body.sharp_left_out(0), 0) << "all are kept: nothing is shown";
  const Patch patch = make_patch(body, Layer::kUpper, crown.top(), Pose());
  for (std::uint32_t t = 1; t < 13; ++t) {
    const double offset_mm = Body::offset_of(body.face(t), Layer::kUpper);
    EXPECT_GE(patch.beyond(-body.normal(t), 0.0), offset_mm - 1e-12) << t;
    EXPECT_GE(patch.thickness(), offset_mm) << t;
  }
}

}  // namespace
}  // namespace mortise
