#include "common/io/scenario/scene_load.h"
#include "common/io/scenario/scene_features.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "tests/unit/io/scene_text.h"

namespace mortise {
namespace {

constexpr const char* kPegInHole = R"(name: peg in hole
units: mm
parts:
  - name: plate
    generator: {kind: ring, bore: 20, outer: 60, width: 20}
    tolerance: "±0.1"
    features:
      bore: {iso: H7}
  - name: pin
    generator: {kind: dowel, diameter: 20, length: 40, phase_deg: 5}
    moving: true
)";

const SurfaceBand::Face* find_face(const SurfaceBand& band, const std::string& name) {
  for (const auto& face : band.faces)
    if (face.name == name) return &face;
  return nullptr;
}

TEST(SceneLoad, FillsTheWorld) {
  const LoadedScene scene = load(kPegInHole);
  ASSERT_TRUE(scene.usable());
  const World& world = scene.world;
  ASSERT_EQ(world.parts.size(), 2U);
  EXPECT_EQ(world.parts[0].id.value, 1U);
  EXPECT_EQ(world.parts[1].name, "pin");
  EXPECT_TRUE(world.parts[1].moving);
  EXPECT_TRUE(world.evaluates);
  EXPECT_TRUE(scene.imports[0].closed);
  // Feature beats part; what is not spoken of follows the part.
  const auto* bore = find_face(world.parts[0].band, "bore");
  const auto* outer = find_face(world.parts[0].band, "outer");
  ASSERT_TRUE(bore && outer);
  EXPECT_NEAR(bore->tolerance_mm.lo, -0.0105, 1e-12);
  EXPECT_EQ(bore->tolerance_source, "Ø20 H7");
  EXPECT_EQ(outer->tolerance_source, "±0.1 mm");
  EXPECT_EQ(bore->grade, DeviationGrade::kDeclaredFeature);
  EXPECT_NEAR(bore->deviation_mm.lo, -0.048152733, 2e-7);
  EXPECT_NEAR(bore->deviation_mm.hi, 0.0, 1e-9);
  // The generator's faces are known exactly even where the file says nothing.
  EXPECT_EQ(find_face(world.parts[1].band, "journal")->tolerance_source, "");
  EXPECT_TRUE(find_face(world.parts[1].band, "journal")->surface.has_value());
}

TEST(SceneLoad, AFitGivesThePairBandsOfItsOwn) {
  const LoadedScene scene = load(std::string(kPegInHole) +
                                 "fits:\n  - {between: [pin.journal, plate.bore], code: H7/g6}\n");
  ASSERT_TRUE(scene.usable()) << scene.findings.front().text;
  const PairRule* rule = &scene.world.pair_rules.at({PartId{1}, PartId{2}});
  ASSERT_TRUE(rule->band_a && rule->band_b);
  EXPECT_EQ(rule->fit, "Ø20 H7/g6");
  EXPECT_EQ(find_face(*rule->band_b, "journal")->tolerance_mm, (Interval{-0.01, -0.0035}));
  EXPECT_EQ(find_face(*rule->band_a, "outer")->tolerance_source, "±0.1 mm");
  EXPECT_EQ(find_face(scene.world.parts[1].band, "journal")->tolerance_mm, (Interval{}));
  ASSERT_EQ(scene.fits.size(), 1U);
  EXPECT_NEAR(scene.fits[0].clearance_mm.lo, 0.007, 1e-12);
  EXPECT_NEAR(scene.fits[0].clearance_mm.hi, 0.041, 1e-12);
}

TEST(SceneLoad, AlikePartsShareTheirMeshAndWildcardsReachThemAll) {
  const LoadedScene scene = load(R"(name: many
units: mm
parts:
  - {name: plate, generator: {kind: ring, bore: 20, outer: 60, width: 20}}
  - {name: pin, generator: {kind: dowel, diameter: 20, length: 40}, moving: true, repeat: {count: 50, step: [100, 0, 0]}}
fits:
  - {between: ["pin_*.journal", plate.bore], code: H7/h6}
exclusions:
  - {between: ["pin_*", "pin_*"], reason: pins never meet here}
)");
  ASSERT_TRUE(scene.usable());
  std::set<const Solid*> solids;
  for (const Part& part : scene.world.parts) solids.insert(part.solid.get());
  EXPECT_EQ(solids.size(), 2U);
  EXPECT_EQ(scene.fits.size(), 50U);
  EXPECT_EQ(scene.world.pair_rules.size(), 50U + 50U * 49U / 2U);
  std::set<const SurfaceBand*> bands;
  for (const auto& [ids, rule] : scene.world.pair_rules) bands.insert(rule.band_b.get());
  EXPECT_EQ(bands.size(), 2U);  // one for all pins, and none where only excluded
}

TEST(SceneLoad, ApprovalsAreOfPairsWithTheirFirstReason) {
  const LoadedScene scene = load(std::string(kPegInHole) +
                                 "approvals:\n  - {between: [pin, plate], reason: pressed in}\n"
                                 "  - {between: [plate, pin], reason: glued}\n");
  ASSERT_TRUE(scene.usable());
  ASSERT_EQ(scene.world.approved_at_start.size(), 1U);
  EXPECT_EQ(scene.world.approved_at_start.begin()->second, "pressed in");
}

TEST(SceneLoad, WithoutAnyKnowledgeNothingIsEvaluated) {
  const LoadedScene scene = load(R"(name: plain
units: mm
parts:
  - {name: a, generator: {kind: block}, moving: true}
  - {name: b, generator: {kind: block}}
)");
  ASSERT_TRUE(scene.usable());
  EXPECT_FALSE(scene.world.evaluates);
}

TEST(SceneLoad, RulesThatMatchNothingOrContradictAreErrors) {
  const std::string base = kPegInHole;  // 11 lines: rules start in line 13
  expect_error(load(base + "fits:\n  - {between: [pin.jornal, plate.bore], code: H7/g6}\n"), 13,
               "did you mean 'journal'");
  expect_error(load(base + "fits:\n  - {between: [pn.journal, plate.bore], code: H7/g6}\n"), 13,
               "did you mean 'pin'");
  expect_error(load(base + "fits:\n  - {between: [pin.journal, plate.outer], code: H7/g6}\n"), 13,
               "a shaft");
  expect_error(load(base + "fits:\n  - {between: [pin.journal, plate.bore], code: H7/q6}\n"), 13,
               "p and r");
  expect_error(load(base + "fits:\n  - {between: [pin.journal, plate.bore], code: H7/g6}\n"
                           "  - {between: [plate.bore, pin.journal], code: H7/p6}\n"),
               14, "already have a fit in line 13");
  expect_error(load(base + "fits:\n  - {between: [pin.*, pin.*], code: H7/g6}\n"), 13,
               "matches no pair");
  expect_error(load(base + "exclusions:\n  - {between: [pin, lid], reason: r}\n"), 13, "no part");
  expect_error(load(base + "exclusions:\n  - {between: [pin, pin], reason: r}\n"), 13, "needs two");
  expect_error(load(base + "approvals:\n  - {between: [pin, lid], reason: r}\n"), 13, "no part");
  expect_error(load(base + "users:\n  - {name: u, may_hold: [lid]}\n"), 13, "no part");
  expect_error(load(base + "users:\n  - {name: u, may_hold: [plate]}\n"), 13, "moving: true");
}

// A casing with a bore of 20 and one of 8, a pin for each, all in place; rules start in line 11.
constexpr const char* kTwoBores = R"(name: two bores
units: mm
deviation: recognized
parts:
  - {name: wide, generator: {kind: ring, bore: 20, outer: 60, width: 20}}
  - {name: narrow, generator: {kind: ring, bore: 8, outer: 18, width: 20}, pose: {position: [100, 0, 0]}}
  - {name: peg, generator: {kind: dowel, diameter: 20, length: 40, chamfer: 1}, moving: true}
  - {name: pin, generator: {kind: dowel, diameter: 8, length: 40, chamfer: 1}, moving: true, pose: {position: [100, 0, 0]}}
  - {name: lid, generator: {kind: block}, moving: true, pose: {position: [0, 100, 0]}}
fits:
)";

TEST(SceneLoad, ACodeOfPartsTakesTheirOnlyHoleAndShaft) {
  for (const char* between :
       {"[wide, peg]", "[peg, wide]", "[wide.bore, peg]", "[wide, peg.journal]"}) {
    const LoadedScene scene =
        load(std::string(kTwoBores) + "  - {between: " + between + ", code: H7/g6}\n");
    ASSERT_TRUE(scene.usable()) << between << ": " << scene.findings.front().text;
    ASSERT_EQ(scene.fits.size(), 1U) << between;
    EXPECT_EQ(scene.fits[0].code, "Ø20 H7/g6");
    EXPECT_EQ(scene.fits[0].part_a + "." + scene.fits[0].feature_a, "wide.bore");
    EXPECT_EQ(scene.fits[0].part_b + "." + scene.fits[0].feature_b, "peg.journal");
  }
  // Of all parts: those whose axes meet where they stand.
  const LoadedScene all =
      load(std::string(kTwoBores) + "  - {between: [\"*\", \"*\"], code: H7/g6}\n");
  ASSERT_TRUE(all.usable()) << all.findings.front().text;
  ASSERT_EQ(all.fits.size(), 2U);
  EXPECT_EQ(all.fits[0].code, "Ø20 H7/g6");
  EXPECT_EQ(all.fits[1].code, "Ø8 H7/g6");
}

TEST(SceneLoad, ACodeOfPartsWithoutOneSizeSaysWhatThereIs) {
  const std::string base = kTwoBores;
  expect_error(load(base + "  - {between: [wide, lid], code: H7/g6}\n"), 11,
               "no hole and shaft of like size are known of wide and lid");
  expect_error(load(base + "  - {between: [wide, pin], code: H7/g6}\n"), 11, "no hole and shaft");
  expect_error(load(base + "  - {between: [wide, peg], code: H7/q6}\n"), 11, "p and r");
  expect_error(load(base + "  - {between: [wide, peg], code: Ø25 H7/g6}\n"), 11, "wide.bore");
}

// A shaft of 8 and 20 beside a plate with holes of both sizes; rules start in line 8.
std::string two_sizes(const std::string& x, const std::string& code) {
  return "name: two sizes\nunits: mm\nparts:\n"
         "  - {name: plate, generator: {kind: dowel_plate, hole1: 8, hole2: 20}}\n"
         "  - {name: shaft, generator: {kind: shaft, d1: 8, l1: 20, d2: 20, l2: 20, d3: 0}, "
         "moving: "
         "true, pose: {position: [" +
         x + ", 0, 0]}}\nfits:\n  - {between: [plate, shaft], code: " + code + "}\n";
}

TEST(SceneLoad, ACodeOfPartsInSeveralSizesAsksWhich) {
  const LoadedScene beside = load(two_sizes("100", "H7/g6"));
  expect_error(beside, 7, "plate.hole1 / shaft.seat1 Ø8, plate.hole2 / shaft.seat2 Ø20");
  expect_error(beside, 7, "write the size before the code, e.g. Ø8 H7/g6, or name both");
  EXPECT_EQ(beside.findings.size(), 1U);
  for (const LoadedScene& scene : {load(two_sizes("100", "Ø20 H7/g6")),
                                   load(two_sizes("15", "H7/g6"))}) {  // on the axis of 20
    ASSERT_TRUE(scene.usable()) << scene.findings.front().text;
    ASSERT_EQ(scene.fits.size(), 1U);
    EXPECT_EQ(scene.fits[0].feature_a + " " + scene.fits[0].feature_b, "hole2 seat2");
  }
}

TEST(SceneLoad, FeaturesThatContradictTheMeshAreErrors) {
  const auto with = [](const std::string& feature) {
    return load(
        "name: a\nunits: mm\nparts:\n  - name: plate\n    generator: {kind: ring, bore: "
        "16.2, outer: 60, width: 20}\n    moving: true\n    features:\n      " +
        feature + "\n");
  };
  expect_error(with("hole: {kind: cylinder, point: [0,0,0], axis: [0,0,1], radius: 8, inward: "
                    "true}"),
               8, "the mesh has radius 8.1 mm");
  expect_error(with("hol: {iso: H7}"), 8, "known: bore");
  expect_error(with("bore: {iso: g6}"), 8, "is for a shaft");
  expect_error(with("bore: {iso: H7, nominal: 16}"), 8, "16.2 mm is neither");
  expect_error(with("lower: {iso: H7}"), 8, "needs a diameter");
  EXPECT_TRUE(with("bore: {iso: H7}").usable());
}

TEST(SceneLoad, TwoFeaturesOnOneRoundNeedTheirExtents) {
  const std::string start =
      "name: a\nunits: mm\nparts:\n  - name: plate\n    generator: {kind: dowel, diameter: 20, "
      "length: 40}\n    moving: true\n    features:\n";
  const std::string round = "{kind: cylinder, point: [0,0,0], axis: [0,0,1], radius: 10";
  expect_error(load(start + "      one: " + round + "}\n      two: " + round + "}\n"), 9,
               "along: [from, to]");
}

TEST(SceneLoad, MissingMeshesAreFindingsWithTheirLine) {
  expect_error(load("name: a\nunits: mm\nparts:\n  - {name: p, moving: true, mesh: {file: "
                    "nowhere.stl, unit: mm}}\n"),
               4, "nowhere.stl");
  expect_error(load("name: a\nunits: mm\nparts:\n  - {name: p, moving: true, mesh: {file: a.3mf, "
                    "unit: mm}}\n"),
               4, "3mf");
}

TEST(SceneLoad, OpenMeshesAreNamed) {
  const MeshProvider open = [](const Scenario& scenario, const Scenario::PartSpec& part) {
    auto mesh = default_meshes()(scenario, part);
    mesh->mesh.triangles.pop_back();
    mesh->report.closed = false;
    mesh->report.boundary_edges = 3;
    return mesh;
  };
  const auto reading = read_scenario_text(
      "name: a\nunits: mm\nparts:\n  - {name: p, moving: true, generator: {kind: block}}\n",
      "s.yaml");
  const auto scene = load_scene(reading->scenario, open);
  ASSERT_TRUE(scene);
  EXPECT_TRUE(scene->usable());
  bool named = false;
  for (const Finding& f : scene->findings) named |= f.text.find("3 boundary") != std::string::npos;
  EXPECT_TRUE(named);
}

TEST(SceneLoad, AScenarioWithoutPartsIsAnEmptyScene) {
  const auto scene = load_scene(Scenario{}, default_meshes());
  ASSERT_TRUE(scene) << scene.error().text;
  EXPECT_TRUE(scene->usable());
  EXPECT_TRUE(scene->findings.empty());
}

TEST(SceneLoad, AMirroredPartIsAnImageOfItself) {
  const std::string base = R"(name: hands
units: mm
parts:
  - generator: {kind: dowel, diameter: 20, length: 40, chamfer: 1, facets: 32, phase_deg: 3}
    features: {journal: {iso: h6}}
    instances:
      - {name: left}
      - {name: right, mirror: z}
      - {name: third, mirror: x}
  - name: whole
    generator: {kind: dowel, diameter: 20, length: 40, chamfer: 1, facets: 32, phase_deg: 3}
    mirror: z
    features: {journal: {iso: h6}}
)";
  const LoadedScene scene = load(base);
  ASSERT_TRUE(scene.usable()) << scene.findings.front().text;
  const auto& parts = scene.world.parts;
  ASSERT_EQ(parts.size(), 4U);
  const Topology &left = parts[0].solid->topology(), &right = parts[1].solid->topology();
  EXPECT_TRUE(right.closed());
  EXPECT_NEAR(left.volume_mm3, right.volume_mm3, 1e-6);
  EXPECT_NEAR(parts[1].solid->bounds().lo.z(), -parts[0].solid->bounds().hi.z(), 1e-12);
  EXPECT_NE(parts[0].solid->hash(), parts[1].solid->hash());
  EXPECT_NE(parts[1].solid->hash(), parts[2].solid->hash());
  EXPECT_EQ(parts[1].solid->hash(), parts[3].solid->hash());  // an instance is mirrored like a part
  // Its faces are known as well as those of the original.
  const auto* journal = find_face(parts[1].band, "journal");
  ASSERT_TRUE(journal);
  EXPECT_EQ(journal->grade, DeviationGrade::kDeclaredFeature);
  EXPECT_EQ(journal->deviation_mm, find_face(parts[0].band, "journal")->deviation_mm);
}

TEST(SceneLoad, ADeclaredFeatureIsMirroredWithItsPart) {
  const auto reading = read_scenario_text(R"(name: hands
units: mm
parts:
  - name: right
    mesh: {file: l.stl, unit: mm}
    mirror: x
    features:
      side: {kind: plane, point: [1, 2, 3], axis: [1, 0, 0]}
  - name: bad
    mesh: {file: l.stl, unit: mm}
    mirror: w
  - name: worse
    mesh: {file: l.stl, unit: mm, scale: [1, -1, 1]}
  - name: worst
    mesh: {file: l.stl, unit: mm, scale: -1}
)",
                                          "s.yaml");
  ASSERT_TRUE(reading);
  const auto& part = reading->scenario.parts.at(0);
  EXPECT_EQ(part.mesh.mirror, 1U);
  EXPECT_EQ(part.features.at(0).surface.point, Vec3(-1, 2, 3));
  EXPECT_EQ(part.features.at(0).surface.axis, Vec3(-1, 0, 0));
  std::size_t with_advice = 0;
  for (const Finding& f : reading->findings)
    with_advice += f.is_error && f.text.find("mirror") != std::string::npos;
  EXPECT_EQ(with_advice, 3U);
}

// A flat that is no wider than some facets of the round that it is cut from: all its corners lie on
// both surfaces.
TEST(SceneLoad, ANarrowFlatBelongsToItsPlaneWhicheverIsDeclaredFirst) {
  constexpr double kRadius_mm = 10.0, kHalfWidth_mm = 3.0;
  const double off_mm = std::sqrt(kRadius_mm * kRadius_mm - kHalfWidth_mm * kHalfWidth_mm);
  TriangleMesh mesh;
  mesh.points_mm = {Vec3(off_mm, -kHalfWidth_mm, 0), Vec3(off_mm, kHalfWidth_mm, 0),
                    Vec3(off_mm, kHalfWidth_mm, 20), Vec3(off_mm, -kHalfWidth_mm, 20)};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  Feature round, flat;
  round.surface.kind = SurfaceKind::kCylinder;
  round.surface.radius_mm = kRadius_mm;
  flat.surface.kind = SurfaceKind::kPlane;
  flat.surface.point = Vec3(off_mm, 0, 0);
  flat.surface.axis = Vec3::UnitX();
  round.triangles = flat.triangles = {0, 1};
  EXPECT_EQ(owners_of({round, flat}, mesh), (std::vector<std::int32_t>{1, 1}));
  EXPECT_EQ(owners_of({flat, round}, mesh), (std::vector<std::int32_t>{0, 0}));
}

}  // namespace
}  // namespace mortise
