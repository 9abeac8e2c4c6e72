// Parts of a STEP file that people bring into a running session: what the file states of their
// faces comes with them.
#include "common/io/scenario/brought_part.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/io/log/log_records.h"
#include "common/io/scenario/assembly_parts.h"
#include "common/io/step/given_parts.h"
#include "tests/unit/io/revised_session.h"
#include "tests/unit/io/step_samples.h"

namespace mortise {
namespace {

using Kind = StepStatement::Kind;

// The bore is Ø20 H7 by its file, the pins are Ø19.980 to Ø19.993 by limits (g6).
StepDocument toleranced() {
  StepDocument document = test::ring_and_pins();
  StepStatement& bore = document.statements.emplace_back();
  bore.kind = Kind::kSize;
  bore.entity = 12;
  bore.name = "diameter";
  bore.value = 20.0;
  bore.code = "H7";
  bore.faces = {{0, test::cylinder_of(document.parts[0], true)}};
  StepStatement& pin = document.statements.emplace_back();
  pin.kind = Kind::kSize;
  pin.entity = 14;
  pin.name = "diameter";
  pin.value = 20.0;
  pin.limit_lower = 19.980;
  pin.limit_upper = 19.993;
  pin.faces = {{1, test::cylinder_of(document.parts[1], false)}};
  StepStatement& flat = document.statements.emplace_back();
  flat.kind = Kind::kGeometric;
  flat.entity = 16;
  flat.name = "flatness";
  flat.value = 0.1;
  flat.faces = {{0, 1}};
  return document;
}

LoadedScene opened(const StepDocument& document) {
  auto reading = read_scenario_text("name: a\nunits: mm\nassembly: {file: a.step}\n", "s.yaml");
  EXPECT_TRUE(reading);
  add_assembly(*reading, encode(document));
  auto scene = load_scene(reading->scenario, default_meshes());
  EXPECT_TRUE(scene && scene->usable());
  return std::move(*scene);
}

SolidPtr brought_solid(const StepDocument& document, std::uint32_t part) {
  Result<TriangleMesh> mesh = brought_mesh(brought_bytes(document, part));
  EXPECT_TRUE(mesh) << mesh.error().text;
  return std::make_shared<const Solid>(std::move(mesh).value());
}

void expect_alike(const PartShape& brought, const Part& opened) {
  ASSERT_EQ(brought.features.size(), opened.features.size());
  for (std::size_t i = 0; i < opened.features.size(); ++i) {
    EXPECT_EQ(brought.features[i].name, opened.features[i].name);
    EXPECT_EQ(brought.features[i].origin, opened.features[i].origin);
    EXPECT_EQ(brought.features[i].triangles, opened.features[i].triangles);
  }
  ASSERT_EQ(brought.band.faces.size(), opened.band.faces.size());
  EXPECT_EQ(brought.band.face_of_triangle, opened.band.face_of_triangle);
  for (std::size_t i = 0; i < opened.band.faces.size(); ++i) {
    const SurfaceBand::Face &mine = brought.band.faces[i], &theirs = opened.band.faces[i];
    EXPECT_EQ(mine.grade, theirs.grade) << theirs.name;
    EXPECT_EQ(mine.tolerance_source, theirs.tolerance_source) << theirs.name;
    EXPECT_EQ(mine.tolerance_mm.lo, theirs.tolerance_mm.lo) << theirs.name;
    EXPECT_EQ(mine.tolerance_mm.hi, theirs.tolerance_mm.hi) << theirs.name;
    EXPECT_EQ(mine.deviation_mm.lo, theirs.deviation_mm.lo) << theirs.name;
    EXPECT_EQ(mine.deviation_mm.hi, theirs.deviation_mm.hi) << theirs.name;
  }
}

std::string all_of(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += note + "; ";
  return text;
}

TEST(BroughtPart, IsWhatItIsInItsAssembly) {
  const StepDocument document = toleranced();
  const LoadedScene scene = opened(document);
  // Also where the session guesses at meshes of which nothing is stated.
  for (const auto undeclared : {UndeclaredSurface::kNominal, UndeclaredSurface::kRecognized}) {
    for (const std::uint32_t part : {0U, 1U}) {
      SCOPED_TRACE(part);
      const PartShape shape = shape_of(brought_solid(document, part), 0.0, undeclared);
      expect_alike(shape, scene.world.parts[part]);
      ASSERT_NE(shape.stated, nullptr);
      EXPECT_EQ(all_of(shape.notes), "") << "nothing is wrong with it";
    }
  }
  EXPECT_EQ(told_of_unused(listed_when_brought(document)),
            "1 of 3 tolerances that the file states are not used: #16 flatness 0.1 (a form within "
            "the limits of size: it widens nothing)");
}

TEST(BroughtPart, SaysWhatIsWrongWithItsFaces) {
  StepDocument document = toleranced();
  document.parts[0].untriangulated = 2;
  const PartShape ring = shape_of(brought_solid(document, 0), 0.0, UndeclaredSurface::kNominal);
  EXPECT_EQ(all_of(ring.notes), "2 faces could not be tessellated: it is open there; ");
}

TEST(BroughtPart, GoesByAnotherNameThanItsMeshAlone) {
  const StepDocument document = toleranced();
  const SolidPtr solid = brought_solid(document, 0);
  EXPECT_NE(solid->hash(), Solid(document.parts[0].mesh).hash());
  StepDocument other = document;
  other.statements[0].code = "H8";
  EXPECT_NE(solid->hash(), brought_solid(other, 0)->hash());
  EXPECT_EQ(solid->hash(), brought_solid(document, 0)->hash());
  // The log keeps both, and reads them back.
  TriangleMesh again;
  ASSERT_TRUE(log_records::decode(log_records::encode(solid->mesh()), again));
  EXPECT_EQ(mesh_hash(again), solid->hash());
}

TEST(BroughtPart, StatementsAboutSeveralPartsAreToldAsUnused) {
  StepDocument document = toleranced();
  document.statements[0].faces.push_back({1, test::cylinder_of(document.parts[1], false)});
  const auto listed = listed_when_brought(document);
  ASSERT_EQ(listed.size(), 3U);
  EXPECT_FALSE(listed[0].used);
  EXPECT_EQ(listed[0].reason, "it names faces of several parts");
  EXPECT_TRUE(listed[1].used) << listed[1].reason;
  EXPECT_EQ(told_of_unused(listed).substr(0, 52),
            "2 of 3 tolerances that the file states are not used:");
  const PartShape ring = shape_of(brought_solid(document, 0), 0.0, UndeclaredSurface::kNominal);
  for (const SurfaceBand::Face& face : ring.band.faces) EXPECT_EQ(face.tolerance_source, "");
}

TEST(BroughtPart, DamagedBytesAreRefusedOrAreAPart) {
  const std::vector<std::byte> good = brought_bytes(toleranced(), 1);
  for (std::size_t size : {std::size_t{0}, std::size_t{4}, good.size() / 2, good.size() - 1})
    EXPECT_FALSE(brought_mesh({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}));
  EXPECT_FALSE(brought_mesh(encode(toleranced()))) << "an assembly is no part";
  StepDocument many = test::ring_and_pins();
  many.parts[1].faces.resize(50'001, many.parts[1].faces[0]);
  EXPECT_FALSE(brought_mesh(brought_bytes(many, 1)));
  StepDocument none = test::ring_and_pins();
  none.parts[1].mesh = {};
  none.parts[1].face_of_triangle.clear();
  EXPECT_FALSE(brought_mesh(brought_bytes(none, 1)));
  std::mt19937 random(7);
  for (int i = 0; i < 2'000; ++i) {
    std::vector<std::byte> bytes = good;
    for (int k = 0; k < 3; ++k)
      bytes[random() % bytes.size()] = static_cast<std::byte>(random() & 0xff);
    Result<TriangleMesh> mesh = brought_mesh(std::move(bytes));
    if (!mesh || !valid(*mesh)) continue;
    const PartShape shape = shape_of(std::make_shared<const Solid>(std::move(mesh).value()), 0.0,
                                     UndeclaredSurface::kNominal);
    EXPECT_TRUE(valid(shape.band, shape.solid->mesh().triangles.size()));
  }
}

// A surface that the mesh contradicts is no truth: the mesh goes alone, and people are told.
TEST(BroughtPart, SurfacesThatTheMeshContradictsAreNotTaken) {
  StepDocument document = toleranced();
  document.parts[1].faces[test::cylinder_of(document.parts[1], false)].surface.radius_mm = 11.0;
  const PartShape shape = shape_of(brought_solid(document, 1), 0.0, UndeclaredSurface::kNominal);
  EXPECT_TRUE(shape.features.empty());
  EXPECT_EQ(shape.stated, nullptr);
  EXPECT_NE(all_of(shape.notes).find("its faces are not taken as its file states them: "),
            std::string::npos)
      << all_of(shape.notes);
}

// A plate with thousands of like holes, each in two halves: whoever brings it waits for seconds.
TEST(BroughtPart, HalvesOfManyLikeHolesFindEachOther) {
  constexpr std::uint32_t kHoles = 2'000;
  StepPart part;
  part.name = "sieve";
  for (std::uint32_t half = 0; half < 2; ++half)
    for (std::uint32_t hole = 0; hole < kHoles; ++hole) {
      StepFace face;
      face.grade = StepFaceGrade::kExact;
      face.surface.kind = SurfaceKind::kCylinder;
      face.surface.radius_mm = 1.0;
      face.surface.inward = true;
      face.surface.point = Vec3(3.0 * hole, 0.0, 0.0);
      const auto first = static_cast<std::uint32_t>(part.mesh.points_mm.size());
      for (const Vec3& corner : {Vec3(1, 0, 0), Vec3(1, 0, 2), Vec3(0, half == 0 ? 1 : -1, 0)})
        part.mesh.points_mm.push_back(face.surface.point + corner);
      part.mesh.triangles.push_back({first, first + 1, first + 2});
      part.face_of_triangle.push_back(static_cast<std::uint32_t>(part.faces.size()));
      part.faces.push_back(face);
    }
  const StepPartGiven given = given_part(part, "sieve.step");
  EXPECT_EQ(given.part->features.size(), kHoles);
  for (const Feature& feature : given.part->features) EXPECT_EQ(feature.triangles.size(), 2U);
  for (std::uint32_t hole = 0; hole < kHoles; ++hole)
    EXPECT_EQ(given.feature_of_face[hole], given.feature_of_face[kHoles + hole]);
}

// 2. in a session

class BroughtParts : public RevisedPart {
 protected:
  void begin_empty() {
    begin_with(
        "name: revisions\nunits: mm\npolicy: report\ndeviation: recognized\nparts:\n"
        "  - {name: desk, generator: {kind: block, x: 9, y: 9, z: 9}, pose: {position: [0, 0, "
        "-900]}}\n"
        "  - {name: box, generator: {kind: block, x: 9, y: 9, z: 9}, moving: true, "
        "pose: {position: [0, 0, 900]}}\n");
  }
  std::string put(const StepDocument& document, std::uint32_t part) {
    meshes.push_back(brought_solid(document, part));
    world().shapes->add(meshes.back(), 0.0);
    return meshes.back()->hash();
  }
  void add(const StepDocument& document) {
    for (const StepInstance& instance : document.instances) {
      Details details;
      details.edit = PartEdit{part_name_of(instance.path), put(document, instance.part),
                              instance.X_WP, true, 0.0};
      const Reply reply = ask(CommandKind::kAddPart, PartId{}, details);
      ASSERT_EQ(reply.refusal, Refusal::kNone) << reply.text;
    }
  }
  std::string source_of(const std::string& part, const std::string& face) {
    for (const SurfaceBand::Face& f : world().find_part(part)->band.faces)
      if (f.name == face) return f.tolerance_source;
    return "no such face";
  }
  std::vector<std::string> clashes(const World& in) {
    std::vector<std::string> told;
    for (const ClashEvent& clash : snapshot_of(in).open_clashes) {
      const Verdict& v = clash.verdict;
      told.push_back(
          in.find(clash.part_a)->name + " " + in.find(clash.part_b)->name + " " + v.face_a + " " +
          v.face_b + " class " + std::to_string(static_cast<int>(v.collision_class)) + " grade " +
          std::to_string(static_cast<int>(v.grade)) + " " + std::to_string(v.gpd_mm.lo) + " " +
          std::to_string(v.gpd_mm.hi) + " fake below " + std::to_string(v.fake_below_mm) +
          " real above " + std::to_string(v.real_above_mm));
    }
    return told;
  }
};

TEST_F(BroughtParts, AreJudgedAsInAScenarioOfTheirAssembly) {
  StepDocument document = toleranced();
  document.instances[1].X_WP.q = Quat(std::cos(0.02), 0.0, 0.0, std::sin(0.02));  // facets cross
  begin_empty();
  add(document);
  LoadedScene direct = opened(document);
  direct.world.policy = Policy::kReport;
  Scratch other(1);
  for (int i = 0; i < 20; ++i) tick(), step(direct.world, {}, other);
  ASSERT_EQ(clashes(world()).size(), 1U);
  EXPECT_EQ(snapshot_of(world()).open_clashes[0].verdict.grade, DeviationGrade::kDeclaredFeature);
  EXPECT_EQ(clashes(world()), clashes(direct.world));
  expect_the_same_again();
}

TEST_F(BroughtParts, FollowUndoAndRedo) {
  begin_empty();
  add(toleranced());
  ASSERT_EQ(source_of("base/ring", "bore_1"), "Ø20 H7");
  const PartId ring = world().find_part("base/ring")->id;
  ASSERT_EQ(ask(CommandKind::kUndo, ring).refusal, Refusal::kNone);
  EXPECT_FALSE(world().find(ring)->present);
  tick();
  ASSERT_EQ(ask(CommandKind::kRedo, ring).refusal, Refusal::kNone);
  EXPECT_TRUE(world().find(ring)->present);
  EXPECT_EQ(source_of("base/ring", "bore_1"), "Ø20 H7");
  expect_the_same_again();
}

TEST_F(BroughtParts, AnotherRevisionBringsItsOwnTolerances) {
  const StepDocument first = toleranced();
  begin_empty();
  add(first);
  const PartId ring = world().find_part("base/ring")->id;
  StepDocument second = first;
  second.statements[0].code = "H8";
  replace(ring, put(second, 0));
  EXPECT_EQ(source_of("base/ring", "bore_1"), "Ø20 H8");
  tick();
  // What a revision no longer states does not hold.
  StepDocument third = first;
  third.statements.erase(third.statements.begin());
  replace(ring, put(third, 0));
  EXPECT_EQ(source_of("base/ring", "bore_1"), "");
  expect_the_same_again();
  ASSERT_EQ(ask(CommandKind::kUndo, ring).refusal, Refusal::kNone);
  EXPECT_EQ(source_of("base/ring", "bore_1"), "Ø20 H8");
  ASSERT_EQ(ask(CommandKind::kUndo, ring).refusal, Refusal::kNone);
  EXPECT_EQ(source_of("base/ring", "bore_1"), "Ø20 H7");
  expect_the_same_again();
}

TEST_F(BroughtParts, WhatPeopleSaidGoesBeforeAnotherFile) {
  const StepDocument first = toleranced();
  begin_empty();
  add(first);
  const PartId ring = world().find_part("base/ring")->id;
  Details said;
  said.feature = "bore_1";
  said.text = "±0.004";
  ASSERT_EQ(ask(CommandKind::kSetTolerance, ring, said).refusal, Refusal::kNone);
  const std::string live = source_of("base/ring", "bore_1");
  ASSERT_NE(live.find("0.004"), std::string::npos) << live;
  tick();
  StepDocument second = first;
  second.statements[0].code = "H8";
  const std::string told = replace(ring, put(second, 0));
  EXPECT_NE(told.find("tolerances of its file give way to what people said of bore_1"),
            std::string::npos)
      << told;
  EXPECT_EQ(source_of("base/ring", "bore_1"), live);
  expect_the_same_again();
}

TEST_F(BroughtParts, AFaceOfAReplacedMeshIsExactAndKeepsItsName) {
  begin("deviation: recognized\n");  // plate, peg and their fit
  StepDocument document = toleranced();
  document.parts[1] = test::step_part(
      "peg", "dowel", {{"diameter_mm", 20.0}, {"length_mm", 40.0}, {"facets", 48.0}});
  document.statements.erase(document.statements.begin() + 1);
  replace(peg, put(document, 1));
  EXPECT_EQ(fit_of_pair(), "Ø20 H7/k6");
  const Part& now = *world().find(peg);
  const auto journal = std::ranges::find(now.features, "journal", &Feature::name);
  ASSERT_NE(journal, now.features.end());
  EXPECT_EQ(journal->grade, DeviationGrade::kDeclaredFeature);
  for (const Feature& feature : now.features)
    EXPECT_NE(feature.origin, FeatureOrigin::kRecognized) << feature.name;
  expect_the_same_again();
}

}  // namespace
}  // namespace mortise
