// What participants are told that constraints can name.
#include "common/session/guide/feature_table.h"

#include <gtest/gtest.h>

#include "common/geometry/recognition/recognition.h"
#include "common/session/guide/guidance.h"
#include "tests/support/shapes.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

// A peg from z = -5 to 35 about the z axis, its mantle declared with all but the end triangles.
Feature mantle_of(const Solid& peg, FeatureOrigin origin) {
  Feature feature;
  feature.name = "mantle";
  feature.origin = origin;
  feature.surface.kind = SurfaceKind::kCylinder;
  feature.surface.radius_mm = 10.0;
  const TriangleMesh& mesh = peg.mesh();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const double z[3] = {mesh.corner(t, 0).z(), mesh.corner(t, 1).z(), mesh.corner(t, 2).z()};
    if (z[0] != z[1] || z[1] != z[2]) feature.triangles.push_back(t);
  }
  return feature;
}

struct Table : ::testing::Test {
  SessionBuilder session;
  PartId add_peg(const std::string& name) {
    return session.add(name, shapes::peg({10.0, -5.0, 35.0, 48}), at(0, 0, 0), true);
  }
  Part& part(PartId id) { return *session.world.find(id); }
};

TEST_F(Table, TellsNameOriginSurfaceExtentAndMiddle) {
  const PartId peg = add_peg("peg");
  part(peg).features = {mantle_of(*part(peg).solid, FeatureOrigin::kGenerated)};
  const FeatureTable table = feature_table(session.world);
  ASSERT_EQ(table.sets.size(), 1u);
  EXPECT_EQ(table.sets[0].parts, std::vector<PartId>{peg});
  ASSERT_EQ(table.sets[0].features.size(), 1u);
  const FeatureInfo& mantle = table.sets[0].features[0];
  EXPECT_EQ(mantle.name, "mantle");
  EXPECT_EQ(mantle.origin, FeatureOrigin::kGenerated);
  EXPECT_EQ(mantle.kind, SurfaceKind::kCylinder);
  EXPECT_FALSE(mantle.inward);
  EXPECT_EQ(mantle.radius_mm, 10.0);
  EXPECT_EQ(mantle.along_mm, (Interval{-5.0, 35.0}));
  EXPECT_NEAR((mantle.middle_P - Vec3(0, 0, 15)).norm(), 0.0, 1e-9);
  EXPECT_EQ(table.meshes_waiting, 1u);
  EXPECT_EQ(table.meshes_too_large + table.left_out, 0u);
}

TEST_F(Table, OfItsSourcesSaysWhatTheWorldSaid) {
  const PartId peg = add_peg("peg"), other = add_peg("other");
  part(peg).features = {mantle_of(*part(peg).solid, FeatureOrigin::kGenerated)};
  const FeatureSources sources = feature_sources(session.world);
  ASSERT_EQ(sources.parts.size(), 2u);
  EXPECT_EQ(sources.parts[0].features.data(), part(peg).features.data()) << "not copied";
  part(peg).features.change().clear();
  part(other).present = false;
  EXPECT_EQ(feature_sources(session.world).parts.size(), 1u);
  const FeatureTable table = feature_table(sources);
  ASSERT_EQ(table.sets.size(), 1u);
  EXPECT_EQ(table.sets[0].parts, std::vector<PartId>{peg});
  EXPECT_EQ(table.sets[0].features[0].along_mm, (Interval{-5.0, 35.0}));
}

TEST_F(Table, AlikePartsShareASetAndOthersDoNot) {
  const PartId a = add_peg("a"), b = add_peg("b"), c = add_peg("c"), bare = add_peg("bare");
  for (const PartId id : {a, b, c})
    part(id).features = {mantle_of(*part(id).solid, FeatureOrigin::kDeclared)};
  part(c).features.change()[0].surface.radius_mm = 10.01;
  const FeatureTable table = feature_table(session.world);
  ASSERT_EQ(table.sets.size(), 2u);
  EXPECT_EQ(table.sets[0].parts, (std::vector<PartId>{a, b}));
  EXPECT_EQ(table.sets[1].parts, std::vector<PartId>{c});
  EXPECT_EQ(table.meshes_waiting, 1u) << "one mesh of four parts, " << part(bare).name;
}

TEST_F(Table, WhatTheMeshShowsComesBesideWhatIsDeclared) {
  const PartId declared = add_peg("declared"), bare = add_peg("bare");
  part(declared).features = {mantle_of(*part(declared).solid, FeatureOrigin::kDeclared)};
  const std::vector<SolidPtr> meshes = unrecognized_meshes(session.world);
  ASSERT_EQ(meshes.size(), 1u);
  session.world.recognized[meshes[0]->hash()] =
      std::make_shared<const std::vector<Feature>>(recognize_features(*meshes[0]).features);
  EXPECT_TRUE(unrecognized_meshes(session.world).empty());
  const FeatureTable table = feature_table(session.world);
  EXPECT_EQ(table.meshes_waiting, 0u);
  ASSERT_EQ(table.sets.size(), 2u);
  const auto names = [](const FeatureSet& set) {
    std::vector<std::string> all;
    for (const FeatureInfo& feature : set.features) all.push_back(feature.name);
    return all;
  };
  // The recognized shaft is the declared mantle: it is told once.
  EXPECT_EQ(names(table.sets[0]), (std::vector<std::string>{"mantle", "plane_1", "plane_2"}));
  EXPECT_EQ(names(table.sets[1]), (std::vector<std::string>{"shaft_1", "plane_1", "plane_2"}));
  for (const FeatureSet& set : table.sets)
    for (const FeatureInfo& feature : set.features) {
      EXPECT_EQ(feature.origin == FeatureOrigin::kDeclared, feature.name == "mantle");
      // Each can be named in a constraint.
      const Feature* found = find_feature(session.world, set.parts[0], feature.name);
      ASSERT_NE(found, nullptr) << feature.name;
      EXPECT_EQ(found->surface.kind, feature.kind);
      EXPECT_EQ(found->surface.point, feature.point_P);
    }
  EXPECT_EQ(table.sets[1].parts, std::vector<PartId>{bare});
}

TEST_F(Table, ANameThatIsTakenIsToldOnce) {
  const PartId peg = add_peg("peg");
  part(peg).features = {mantle_of(*part(peg).solid, FeatureOrigin::kDeclared)};
  part(peg).features.change()[0].name = "plane_1";
  (void)find_feature(session.world, peg, "shaft_1");  // as a first constraint does
  const FeatureTable table = feature_table(session.world);
  ASSERT_EQ(table.sets.size(), 1u);
  EXPECT_EQ(table.sets[0].features.size(), 2u);  // the other end is still there
}

TEST_F(Table, WhatIsTooLargeOrTooMuchIsCounted) {
  const PartId peg = add_peg("peg");
  part(peg).features = {mantle_of(*part(peg).solid, FeatureOrigin::kDeclared)};
  session.add("fine", shapes::sphere(10.0, Vec3::Zero(), 80), at(50, 0, 0), false);
  ASSERT_GT(session.world.parts.back().solid->mesh().triangles.size(), kRecognizedOnDemand);
  FeatureTable table = feature_table(session.world);
  EXPECT_EQ(table.meshes_too_large, 1u);
  EXPECT_EQ(table.meshes_waiting, 1u);
  EXPECT_EQ(unrecognized_meshes(session.world).size(), 1u);
  table = feature_table(session.world, 0);
  EXPECT_EQ(table.left_out, 1u);
  EXPECT_TRUE(table.sets.empty());
}

}  // namespace
}  // namespace mortise
