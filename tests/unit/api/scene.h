#pragma once
#include <gtest/gtest.h>
#include <mortise/geometry.h>

#include <cmath>
#include <numbers>

namespace mortise::test {

inline const char* why(const api::Error& error) { return error.text.c_str(); }

/// A box from `lo` to `hi`, closed.
inline Mesh box_mesh(const Vec3& lo, const Vec3& hi) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.points_mm.emplace_back(i & 1 ? hi.x() : lo.x(), i & 2 ? hi.y() : lo.y(),
                                i & 4 ? hi.z() : lo.z());
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline api::Part made(api::Result<api::Part> part) {
  EXPECT_TRUE(part) << (part ? "" : why(part.error()));
  return *part;
}

inline api::Part cube(double size_mm, const std::string& name) {
  return made(Part::from_mesh(box_mesh(Vec3::Zero(), Vec3::Constant(size_mm)), name));
}

inline api::Result<api::Part> plate() {
  return Part::generate("plate_with_bore", {{"bore_mm", 20}, {"facets", 32}}, "plate");
}

/// Half a facet out of phase with the bore, so that the meshes overlap by 48.2 µm.
inline api::Result<api::Part> peg() {
  return Part::generate("dowel",
                        {{"diameter_mm", 20},
                         {"length_mm", 40},
                         {"chamfer_mm", 1},
                         {"facets", 32},
                         {"phase_rad", std::numbers::pi / 32}},
                        "peg");
}

inline Pose shift(double x, double y, double z) { return Pose(Eigen::Translation3d(x, y, z)); }

}  // namespace mortise::test
