#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "common/io/scenario/scene_load.h"
#include "common/session/tick/judge_world.h"
#include "common/session/tick/step.h"
#include "tests/unit/io/scene_text.h"

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

const SurfaceBand::Face& face_of(const SurfaceBand& band, const std::string& name) {
  for (const auto& face : band.faces)
    if (face.name == name) return face;
  ADD_FAILURE() << "no face " << name;
  return band.faces[0];
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

// A hole Ø10 H7 and a pin Ø10 g6, coaxial as modelled. The numbers are those of 2e7 draws of both
// diameters and both components of the axis, made apart from this program.
TEST(Position, IsDrawnAsAPlaceOfTheAxis) {
  const auto judged = [](const std::string& position) {
    LoadedScene scene = load(
        "name: pin in plate\nunits: mm\nparts:\n"
        "  - name: plate\n    generator: {kind: ring, bore: 10, outer: 40, width: 20}\n"
        "    features:\n      bore: {iso: H7, position: " +
        position +
        "}\n  - name: pin\n    generator: {kind: dowel, diameter: 10, length: 40, phase_deg: 5}\n"
        "    moving: true\n    features:\n      journal: {iso: g6}\n");
    Scratch scratch;
    const JudgeReport report = judge_world(scene.world, scratch, false);
    EXPECT_EQ(report.pairs.size(), 1U);
    const Verdict verdict = report.pairs.at(0).verdicts.at(0);
    EXPECT_EQ(verdict.collision_class, CollisionClass::kPotential) << verdict.explanation;
    return verdict;
  };
  EXPECT_NEAR(judged("0.02").probability, 0.05976, 0.001) << judged("0.02").explanation;
  EXPECT_NEAR(judged("0.03").probability, 0.25350, 0.001) << judged("0.03").explanation;
  EXPECT_FALSE(has_probability(judged("{zone: 0.03, at: mmc}")));
}

// At maximum material the outer ends stay at the virtual conditions, hole MMC - T and pin MMC + T;
// the other ends get the bonus: what the size leaves of its tolerance.
TEST(Position, UnderAMaterialConditionOneEndIsTheVirtualCondition) {
  const LoadedScene mmc = load(peg_in_hole(kPlain, "iso: H7, position: {zone: 0.1, at: mmc}",
                                           "iso: g6, position: {zone: 0.02, at: mmc}"));
  ASSERT_TRUE(mmc.usable()) << mmc.findings[0].text;
  // hole 0/+21, T 100: inwards to 10 - 0.05, outwards to 10.0105 + (0.1 + 0.021)/2
  expect_face(mmc.world.parts[0].band, "bore", {-71, 50}, "Ø20 H7, position Ø0.1 mm at MMC");
  // pin -20/-7, T 20: outwards to 9.9965 + 0.01, inwards to 9.99 - (0.02 + 0.013)/2
  expect_face(mmc.world.parts[1].band, "journal", {-26.5, 6.5}, "Ø20 g6, position Ø0.02 mm at MMC");
  const LoadedScene lmc = load(peg_in_hole(kPlain, "iso: H7, position: {zone: 0.1, at: lmc}",
                                           "iso: g6, position: {zone: 0.02, at: lmc}"));
  expect_face(lmc.world.parts[0].band, "bore", {-60.5, 60.5}, "Ø20 H7, position Ø0.1 mm at LMC");
  expect_face(lmc.world.parts[1].band, "journal", {-20, 13}, "Ø20 g6, position Ø0.02 mm at LMC");
}

// Every admissible part, drawn: its surface stays within the zone, and comes near both ends.
TEST(Position, DrawnPartsStayWithinTheirZoneAndReachItsEnds) {
  std::mt19937_64 random(515);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const char* at : {"rfs", "mmc", "lmc"})
    for (const bool hole : {true, false}) {
      const std::string position = std::string(", position: {zone: 0.03, at: ") + at + "}";
      const LoadedScene scene =
          load(peg_in_hole(kPlain, "iso: H7" + (hole ? position : std::string()),
                           "iso: g6" + (hole ? std::string() : position)));
      const Interval zone =
          face_of(scene.world.parts[hole ? 0 : 1].band, hole ? "bore" : "journal").tolerance_mm;
      const Interval limits = hole ? Interval{0.0, 0.021} : Interval{-0.020, -0.007};
      Interval seen{1.0, -1.0};
      for (int i = 0; i < 20000; ++i) {
        // Corners of what may be drawn as often as its inside.
        const double u = unit(random), share = u < 0.25 ? 0.0 : u < 0.5 ? 1.0 : unit(random);
        const double size = limits.lo + share * limits.width();
        const double from_mmc = hole ? size - limits.lo : limits.hi - size;
        const double bonus = at[0] == 'r'   ? 0.0
                             : at[0] == 'm' ? from_mmc
                                            : limits.width() - from_mmc;
        const double shift = 0.5 * (0.03 + bonus) * (2.0 * unit(random) - 1.0);
        const double grown = 0.5 * size;  // of the radius
        const double outward = (hole ? -grown : grown) + shift;
        ASSERT_TRUE(zone.contains(outward + (outward > zone.middle() ? -1e-12 : 1e-12)))
            << at << hole << " " << outward;
        seen = {std::min(seen.lo, outward), std::max(seen.hi, outward)};
      }
      EXPECT_NEAR(seen.lo, zone.lo, 2e-4) << at << hole;
      EXPECT_NEAR(seen.hi, zone.hi, 2e-4) << at << hole;
    }
}

TEST(Position, AConditionCountsFromTheFeaturesOwnLimits) {
  // The pair narrows the bore to -6.5 to 0, the virtual condition stays where H7 puts it.
  const LoadedScene scene =
      load(peg_in_hole(kPlain, "iso: H7, position: {zone: 0.1, at: mmc}", "iso: g6",
                       "fits:\n  - {between: [pin.journal, plate.bore], code: H6/g6}\n"));
  ASSERT_TRUE(scene.usable());
  const PairRule& rule = scene.world.pair_rules.at({PartId{1}, PartId{2}});
  expect_face(*rule.band_a, "bore", {-63, 50}, "Ø20 H6, position Ø0.1 mm at MMC");
  expect_error(load(peg_in_hole(kPlain, "position: {zone: 0.1, at: mmc}", "iso: g6")), 8,
               "counts from the limits of size", "add iso");
}

TEST(Position, NeedsAFeatureOfSize) {
  const LoadedScene scene = load(
      "name: a\nunits: mm\nparts:\n  - name: plate\n    generator: {kind: ring, bore: 20, outer: "
      "60, width: 20}\n    moving: true\n    features:\n      lower: {position: 0.1}\n");
  expect_error(scene, 8, "position needs a feature of size", "use profile");
}

// A key of width 8 in a slot of width 8, half a millimetre above its floor. Lines: slot 4, its
// flank 7; key 8, its flank 13.
std::string key_in_slot(const std::string& slot, const std::string& key) {
  return "name: key\nunits: mm\nparts:\n"
         "  - name: slot\n    generator: {kind: slot_block, slot_width: 8}\n    features:\n"
         "      slot_left: {" +
         slot +
         "}\n  - name: key\n    generator: {kind: key, width: 8, height: 7, length: 20}\n"
         "    pose: {position: [0, 0.5, -10], rotation_deg: [0, 0, 90]}\n    moving: true\n"
         "    features:\n      front: {" +
         key + "}\n";
}

TEST(Width, BothPlanesTakeHalfOfTheDeviations) {
  const LoadedScene scene =
      load(key_in_slot("iso: N9, width_to: slot_right", "iso: 8 h9, width_to: back"));
  ASSERT_TRUE(scene.usable()) << scene.findings[0].text;
  for (const char* flank : {"slot_left", "slot_right"})
    expect_face(scene.world.parts[0].band, flank, {0, 18}, "8 N9");
  expect_face(scene.world.parts[0].band, "slot_floor", {0, 0}, "");
  for (const char* flank : {"front", "back"})
    expect_face(scene.world.parts[1].band, flank, {-18, 0}, "8 h9");
  expect_face(scene.world.parts[1].band, "left", {0, 0}, "");
}

TEST(Width, AKeyInItsSlotIsJudgedAsItsLimitsSay) {
  struct Row {
    const char *slot, *key;
    CollisionClass expected;
  };
  // Per flank, µm: D10/h9 leaves 20 to 67; N9/h9 interferes -18 to 18; P9/s7 interferes 19 to 44.5.
  constexpr Row kRows[] = {{"D10", "h9", CollisionClass::kNone},
                           {"N9", "h9", CollisionClass::kPotential},
                           {"P9", "s7", CollisionClass::kReal}};
  for (const Row& row : kRows) {
    LoadedScene scene = load(key_in_slot(std::string("iso: ") + row.slot + ", width_to: slot_right",
                                         std::string("iso: ") + row.key + ", width_to: back"));
    ASSERT_TRUE(scene.usable()) << scene.findings[0].text;
    Scratch scratch;
    const JudgeReport report = judge_world(scene.world, scratch, true);
    CollisionClass worst = CollisionClass::kNone;
    std::string sentence;
    for (const PairVerdicts& pair : report.pairs)
      for (const Verdict& verdict : pair.verdicts) {
        if (sentence.empty()) sentence = verdict.explanation;
        worst = std::max(worst, verdict.collision_class);
      }
    EXPECT_EQ(worst, row.expected) << row.slot << "/" << row.key << ": " << sentence;
    if (row.expected != CollisionClass::kNone) {
      EXPECT_NE(sentence.find(std::string("8 ") + row.slot + "/" + row.key), std::string::npos)
          << sentence;
    }
  }
}

TEST(Width, WhatIsNoWidthIsRefused) {
  const auto slot = [](const std::string& text) {
    return load(key_in_slot(text, "iso: h9, width_to: back"));
  };
  expect_error(slot("iso: h9, width_to: slot_right"), 7, "class h9 is for a key",
               "face each other");
  expect_error(slot("iso: N9, width_to: slot_floor"), 7, "width_to slot_floor", "parallel");
  expect_error(slot("iso: N9, width_to: slot_rihgt"), 7, "no feature 'slot_rihgt'",
               "opposite plane");
  expect_error(slot("iso: N9"), 7, "needs a diameter", "width_to");
  expect_error(slot("iso: 9 N9, width_to: slot_right"), 7, "modelled width 8 mm", "9 N9");
  // The other plane's own statement and the width hold together, or exclude each other.
  const auto both = [](const std::string& other) {
    return load(key_in_slot("iso: N9, width_to: slot_right}\n      slot_right: {" + other,
                            "iso: h9, width_to: back"));
  };
  const LoadedScene tight = both("tolerance: \"±0.005\"");
  expect_face(tight.world.parts[0].band, "slot_right", {0, 5}, "±0.005 mm and 8 N9");
  expect_error(both("tolerance: {lower: -0.02, upper: -0.01}"), 8, "8 N9 (line 7)", "(line 8)");
}

}  // namespace
}  // namespace mortise
