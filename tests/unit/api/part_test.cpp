#include <limits>

#include "tests/unit/api/scene.h"

namespace mortise::test {
namespace {

TEST(Part, AMeshComesBackAsItWasGiven) {
  const Part part = cube(10, "cube");
  EXPECT_EQ(part.name(), "cube");
  EXPECT_EQ(part.triangle_count(), 12u);
  EXPECT_EQ(part.mesh().points_mm.size(), 8u);
  EXPECT_TRUE(part.has_inside());
  EXPECT_NEAR(part.volume_mm3(), 1000.0, 1e-9);
  EXPECT_EQ(part.hash().size(), 32u);
  EXPECT_EQ(part.hash(), cube(10, "other").hash());
  EXPECT_NE(part.hash(), cube(11, "other").hash());
  EXPECT_TRUE(part.notes().empty());
  EXPECT_EQ(part.features().size(), 6u);
}

TEST(Part, LooseTrianglesAreJoinedAndInwardOnesTurned) {
  const Mesh closed = box_mesh(Vec3::Zero(), Vec3::Constant(10));
  Mesh loose;
  for (const auto& triangle : closed.triangles) {
    const auto first = static_cast<std::uint32_t>(loose.points_mm.size());
    for (const int k : {0, 2, 1}) loose.points_mm.push_back(closed.points_mm[triangle[k]]);
    loose.triangles.push_back({first, first + 1, first + 2});
  }
  const Part part = made(Part::from_mesh(loose));
  EXPECT_EQ(part.mesh().points_mm.size(), 8u);
  EXPECT_NEAR(part.volume_mm3(), 1000.0, 1e-9);
  ASSERT_EQ(part.notes().size(), 1u);
  EXPECT_NE(part.notes().front().find("turned"), std::string::npos);
}

TEST(Part, AnOpenMeshSaysSo) {
  Mesh open = box_mesh(Vec3::Zero(), Vec3::Constant(10));
  open.triangles.pop_back();
  const Part part = made(Part::from_mesh(open));
  EXPECT_FALSE(part.has_inside());
  ASSERT_FALSE(part.notes().empty());
  EXPECT_NE(part.notes().back().find("is open"), std::string::npos);
}

TEST(Part, WhatIsNoMeshIsRefused) {
  Mesh mesh = box_mesh(Vec3::Zero(), Vec3::Constant(10));
  mesh.triangles[3][1] = 8;
  const auto beyond = Part::from_mesh(mesh, "bad");
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().code, Code::kInvalidInput);
  EXPECT_EQ(beyond.error().text, "part bad: triangle 3 names point 8 of 8");
  for (const double x : {std::nan(""), std::numeric_limits<double>::infinity(), 1.1e7}) {
    mesh = box_mesh(Vec3::Zero(), Vec3::Constant(10));
    mesh.points_mm[2].y() = x;
    EXPECT_FALSE(Part::from_mesh(mesh)) << x;
  }
  EXPECT_TRUE(Part::from_mesh(box_mesh(Vec3::Zero(), Vec3(1e7, 10, 10)))) << "as of a file";
  EXPECT_FALSE(Part::from_mesh({}));
  mesh = box_mesh(Vec3::Zero(), Vec3(10, 10, 0));
  mesh.triangles = {{0, 1, 1}};
  EXPECT_FALSE(Part::from_mesh(mesh));
}

TEST(Part, GeneratedOnesHaveExactSurfaces) {
  const Part part = made(plate());
  const auto& features = part.features();
  const auto bore = std::find_if(features.begin(), features.end(),
                                 [](const Feature& f) { return f.name == "bore"; });
  ASSERT_NE(bore, features.end());
  EXPECT_EQ(bore->kind, "cylinder");
  EXPECT_TRUE(bore->inward);
  EXPECT_DOUBLE_EQ(bore->radius_mm, 10.0);
  EXPECT_FALSE(Part::generate("no_such_kind", {}));
  EXPECT_FALSE(Part::generate("dowel", {{"no_such_parameter", 1}}));
}

TEST(Part, NamesAreLegal) {
  EXPECT_EQ(cube(1, "a.b*c").name(), "a_b_c");
  EXPECT_EQ(cube(1, "").name(), "part");
  EXPECT_EQ(cube(1, "a").named("arm/horn").name(), "arm/horn");
}

}  // namespace
}  // namespace mortise::test
