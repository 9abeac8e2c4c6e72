#include <gtest/gtest.h>

#include <random>
#include <string>

#include "common/io/scene_load.h"

// Statements of part, feature and pair about the same face: all of them hold.
namespace mortise {
namespace {

// Lines: plate 4, its tolerance 6, bore 8; pin 9, journal 13.
std::string peg_in_hole(const std::string& plate, const std::string& bore,
                        const std::string& journal, const std::string& fits = "") {
  return "name: peg in hole\nunits: mm\nparts:\n"
         "  - name: plate\n    generator: {kind: ring, bore: 20, outer: 60, width: 20}\n    " +
         plate + "\n    features:\n      bore: {" + bore +
         "}\n  - name: pin\n    generator: {kind: dowel, diameter: 20, length: 40, phase_deg: 5}\n"
         "    moving: true\n    features:\n      journal: {" +
         journal + "}\n" + fits;
}

LoadedScene load(const std::string& yaml) {
  const auto reading = read_scenario_text(yaml, "s.yaml");
  EXPECT_TRUE(reading);
  for (const Finding& f : reading->findings) EXPECT_FALSE(f.is_error) << f.text;
  auto scene = load_scene(reading->scenario, default_meshes());
  EXPECT_TRUE(scene);
  return std::move(scene).value();
}

const SurfaceBand::Face& face_of(const SurfaceBand& band, const std::string& name) {
  for (const auto& face : band.faces)
    if (face.name == name) return face;
  ADD_FAILURE() << "no face " << name;
  return band.faces[0];
}

void expect_error(const LoadedScene& scene, int line, const std::string& says,
                  const std::string& and_says) {
  EXPECT_FALSE(scene.usable());
  std::string all;
  for (const Finding& f : scene.findings) {
    all += f.text + "\n";
    if (f.is_error && f.text.starts_with("s.yaml:" + std::to_string(line) + ": ") &&
        f.text.find(says) != std::string::npos && f.text.find(and_says) != std::string::npos)
      return;
  }
  ADD_FAILURE() << "wanted line " << line << ": " << says << " ... " << and_says << "\ngot\n"
                << all;
}

void expect_face(const SurfaceBand& band, const std::string& name, Interval offset_um,
                 const std::string& source) {
  const SurfaceBand::Face& face = face_of(band, name);
  EXPECT_NEAR(face.tolerance_mm.lo * 1e3, offset_um.lo, 1e-9) << name;
  EXPECT_NEAR(face.tolerance_mm.hi * 1e3, offset_um.hi, 1e-9) << name;
  EXPECT_EQ(face.tolerance_source, source);
}

const char* const kPlain = "moving: false";
const char* const kFit = "fits:\n  - {between: [pin.journal, plate.bore], code: H7/g6}\n";

TEST(Combination, TheTighterOfPartAndFeatureHolds) {
  const LoadedScene wide = load(peg_in_hole("tolerance: \"±0.1\"", "iso: H7", "iso: g6"));
  ASSERT_TRUE(wide.usable());
  expect_face(wide.world.parts[0].band, "bore", {-10.5, 0}, "Ø20 H7");
  expect_face(wide.world.parts[0].band, "outer", {-100, 100}, "±0.1 mm");
  expect_face(wide.world.parts[0].band, "", {-100, 100}, "±0.1 mm");
  const LoadedScene narrow =
      load(peg_in_hole("tolerance: \"±0.002\"", "tolerance: \"±0.01\"", "iso: g6"));
  expect_face(narrow.world.parts[0].band, "bore", {-2, 2}, "±0.002 mm");
  // Each bounds one end: both are named.
  const LoadedScene crossed = load(peg_in_hole("tolerance: \"±0.005\"", "iso: H7", "iso: g6"));
  expect_face(crossed.world.parts[0].band, "bore", {-5, 0}, "±0.005 mm and Ø20 H7");
}

TEST(Combination, TheTighterOfFeatureAndPairHolds) {
  const LoadedScene feature = load(peg_in_hole(kPlain, "iso: H6", "iso: g6", kFit));
  ASSERT_TRUE(feature.usable());
  const PairRule& rule = feature.world.pair_rules.at({PartId{1}, PartId{2}});
  expect_face(*rule.band_a, "bore", {-6.5, 0}, "Ø20 H6");
  expect_face(*rule.band_b, "journal", {-10, -3.5}, "Ø20 g6");
  ASSERT_EQ(feature.fits.size(), 1U);
  EXPECT_EQ(feature.fits[0].code, "Ø20 H7/g6");
  EXPECT_EQ(feature.fits[0].tighter, std::vector<std::string>{"plate.bore: Ø20 H6"});
  EXPECT_NEAR(feature.fits[0].clearance_mm.lo, 0.007, 1e-12);
  EXPECT_NEAR(feature.fits[0].clearance_mm.hi, 0.033, 1e-12);

  const LoadedScene pair = load(peg_in_hole(kPlain, "iso: H9", "iso: g9", kFit));
  const PairRule& tight = pair.world.pair_rules.at({PartId{1}, PartId{2}});
  expect_face(*tight.band_a, "bore", {-10.5, 0}, "Ø20 H7");
  expect_face(*tight.band_b, "journal", {-10, -3.5}, "Ø20 g6");
  EXPECT_TRUE(pair.fits[0].tighter.empty());
  expect_face(pair.world.parts[0].band, "bore", {-26, 0}, "Ø20 H9");  // beside other parts
}

TEST(Combination, APairOfWholePartsHoldsForEveryFaceBesideItsOwn) {
  const LoadedScene scene =
      load(peg_in_hole("tolerance: \"±0.1\"", "iso: H7", "iso: g6",
                       "fits:\n  - {between: [pin, plate], plus_minus: 0.008}\n"));
  ASSERT_TRUE(scene.usable());
  const PairRule& rule = scene.world.pair_rules.at({PartId{1}, PartId{2}});
  expect_face(*rule.band_a, "bore", {-8, 0}, "Ø20 H7 and ±0.008 mm");
  expect_face(*rule.band_a, "outer", {-8, 8}, "±0.008 mm");
  expect_face(*rule.band_b, "journal", {-8, -3.5}, "Ø20 g6 and ±0.008 mm");
}

TEST(Combination, TwoFitsOfOneFaceInOnePairHoldBoth) {
  const LoadedScene scene = load(
      peg_in_hole(kPlain, "iso: H11", "iso: g6",
                  std::string(kFit) + "  - {between: [pin.journal, plate], plus_minus: 0.006}\n"));
  ASSERT_TRUE(scene.usable()) << scene.findings[0].text;
  const PairRule& rule = scene.world.pair_rules.at({PartId{1}, PartId{2}});
  expect_face(*rule.band_a, "bore", {-6, 0}, "Ø20 H11 and ±0.006 mm");
}

TEST(Combination, StatementsThatExcludeEachOtherNameBothLines) {
  // bore H7 is -10.5 to 0; 0.02 to 0.03 outward leaves nothing.
  expect_error(load(peg_in_hole("tolerance: {lower: 0.02, upper: 0.03}", "iso: H7", "iso: g6")), 8,
               "(line 6) wants the surface 20 to 30",
               "Ø20 H7 (line 8) wants the surface -10.5 to 0");
  expect_error(load(peg_in_hole(kPlain, "iso: H7", "iso: p6", kFit)), 15, "p6 (line 13)",
               "g6 (line 15)");
  expect_error(
      load(peg_in_hole(kPlain, "tolerance: {lower: 0.001, upper: 0.002}", "iso: g6", kFit)), 15,
      "surface 0.001/0.002 mm (line 8)", "H7 (line 15)");
  expect_error(load(peg_in_hole(
                   kPlain, "iso: H7", "iso: g6",
                   std::string(kFit) + "  - {between: [pin, plate], lower: 0.01, upper: 0.02}\n")),
               16, "no surface satisfies both", "(line 16)");
}

// What the loader makes of three levels is the intersection of what each level makes alone.
TEST(Combination, AgreesWithIntersectingEachLevelAlone) {
  std::mt19937_64 random(90210);
  std::uniform_real_distribution<double> end(-0.02, 0.02);
  int possible = 0, impossible = 0;
  for (int i = 0; i < 60; ++i) {
    Interval levels[3];
    std::string text[3];
    for (int k = 0; k < 3; ++k) {
      const double x = end(random), y = end(random);
      levels[k] = {std::min(x, y), std::max(x, y)};
      text[k] =
          "lower: " + std::to_string(levels[k].lo) + ", upper: " + std::to_string(levels[k].hi);
      levels[k] = {std::stod(std::to_string(levels[k].lo)),
                   std::stod(std::to_string(levels[k].hi))};
    }
    const double lo = std::max({levels[0].lo, levels[1].lo, levels[2].lo});
    const double hi = std::min({levels[0].hi, levels[1].hi, levels[2].hi});
    const LoadedScene scene = load(peg_in_hole(
        "tolerance: {" + text[0] + "}", "tolerance: {" + text[1] + "}", "position: 0.01",
        "fits:\n  - {between: [pin, plate.bore], " + text[2] + "}\n"));
    ASSERT_EQ(scene.usable(), lo <= hi) << text[0] << " | " << text[1] << " | " << text[2];
    ++(lo <= hi ? possible : impossible);
    if (lo > hi) continue;
    const SurfaceBand& band = *scene.world.pair_rules.at({PartId{1}, PartId{2}}).band_a;
    EXPECT_NEAR(face_of(band, "bore").tolerance_mm.lo, lo, 1.1e-6);
    EXPECT_NEAR(face_of(band, "bore").tolerance_mm.hi, hi, 1.1e-6);
  }
  EXPECT_GT(possible, 5);
  EXPECT_GT(impossible, 5);
}

TEST(Position, AddsToSizeAndIsNoTighterStatement) {
  const LoadedScene scene =
      load(peg_in_hole("tolerance: \"±0.1\"", "iso: H7, position: 0.1", "iso: g6", kFit));
  ASSERT_TRUE(scene.usable());
  expect_face(scene.world.parts[0].band, "bore", {-60.5, 50}, "Ø20 H7, position Ø0.1 mm");
  const PairRule& rule = scene.world.pair_rules.at({PartId{1}, PartId{2}});
  expect_face(*rule.band_a, "bore", {-60.5, 50}, "Ø20 H7, position Ø0.1 mm");
  expect_face(*rule.band_b, "journal", {-10, -3.5}, "Ø20 g6");
  EXPECT_EQ(scene.fits[0].tighter,
            std::vector<std::string>{"plate.bore: Ø20 H7, position Ø0.1 mm"});
  EXPECT_NEAR(scene.fits[0].clearance_mm.lo, 0.007 - 0.1, 1e-12);
  EXPECT_NEAR(scene.fits[0].clearance_mm.hi, 0.041 + 0.1, 1e-12);
  const LoadedScene alone = load(peg_in_hole(kPlain, "position: 0.04", "iso: g6"));
  expect_face(alone.world.parts[0].band, "bore", {-20, 20}, "position Ø0.04 mm");
}

TEST(Position, NeedsAFeatureOfSize) {
  const LoadedScene scene = load(
      "name: a\nunits: mm\nparts:\n  - name: plate\n    generator: {kind: ring, bore: 20, outer: "
      "60, width: 20}\n    moving: true\n    features:\n      lower: {position: 0.1}\n");
  expect_error(scene, 8, "position needs a feature of size", "use profile");
}

}  // namespace
}  // namespace mortise
