#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "common/evaluation/explain.h"
#include "common/evaluation/verdict.h"
#include "tests/unit/evaluation/fit_faces.h"

namespace mortise {
namespace {

SurfaceBand::Face face(const char* source, Interval tolerance) {
  SurfaceBand::Face f;
  f.tolerance_source = source;
  f.tolerance_mm = tolerance;
  return f;
}

TEST(Explain, TheSentenceOfAFit) {
  const SurfaceBand::Face hole = face("Ø20 H7", {-0.0105, 0}),
                          shaft = face("Ø20 g6", {-0.010, -0.0035});
  ExplainInput in;
  in.collision_class = CollisionClass::kFake;
  in.delta_mm = {kSagitta_mm, kSagitta_mm};
  in.tolerance_mm = {-0.0205, -0.0035};
  in.thresholds = {kSagitta_mm + 0.0035, kSagitta_mm + 0.0205};
  in.margin_mm = 0.0035;
  in.grade = DeviationGrade::kDeclaredFeature;
  in.face_a = &shaft;
  in.face_b = &hole;
  EXPECT_EQ(explain(in),
            "overlap 48.2 µm; fake up to 51.7 µm (mesh error 48.2 µm exact + least radial "
            "clearance 3.5 µm of Ø20 H7/g6), real above 68.7 µm: fake, 3.5 µm to spare");
}

// A round face that is declared beside one of which nothing is.
TEST(Explain, TheChordsOfADeclaredFaceAreNoRounding) {
  SurfaceBand::Face round, flat;
  round.grade = DeviationGrade::kDeclaredFeature;
  round.surface.emplace();
  round.deviation_mm = {-0.0482, 0.0};
  flat.grade = DeviationGrade::kNominal;
  ExplainInput in;
  in.collision_class = CollisionClass::kFake;
  in.delta_mm = {0.03, 0.03};
  in.thresholds = {0.0482, 0.0482};
  in.margin_mm = 0.0182;
  in.grade = DeviationGrade::kNominal;
  in.face_a = &round;
  in.face_b = &flat;
  EXPECT_EQ(explain(in).find("rounding"), std::string::npos) << explain(in);
  EXPECT_NE(explain(in).find("mesh error 48.2 µm"), std::string::npos) << explain(in);
}

// A search that ends before it knows what is certain shows no rounding.
TEST(Explain, OnlyWhatRoundingCoversIsWithinIt) {
  SurfaceBand::Face flat;
  flat.grade = DeviationGrade::kPlanar;
  flat.deviation_mm = {-1e-6, 1e-6};
  ExplainInput in;
  in.collision_class = CollisionClass::kPotential;
  in.grade = DeviationGrade::kPlanar;
  in.face_a = in.face_b = &flat;
  const auto told = [&](Interval delta_mm, double real_above_mm) {
    in.delta_mm = delta_mm;
    in.thresholds = {-1.0, real_above_mm};
    return explain(in).find("within the rounding of the files") != std::string::npos;
  };
  EXPECT_TRUE(told({1e-6, 1.1e-6}, 2e-6));
  EXPECT_TRUE(told({3e-5, 3e-5}, 4e-5)) << "at a sharp edge";
  EXPECT_FALSE(told({0.265, 0.318}, 0.265));
}

TEST(Explain, OtherSentences) {
  ExplainInput in;
  in.collision_class = CollisionClass::kReal;
  in.delta_mm = {0.2, 0.2};
  in.grade = DeviationGrade::kNominal;
  in.margin_mm = 0.2;
  EXPECT_EQ(explain(in),
            "overlap 200.0 µm; nothing declared, the mesh is taken for the surface (nominal): "
            "real, 200.0 µm beyond");
  const SurfaceBand::Face zone = face("profile 0.1 mm", {-0.05, 0.05});
  in = {};
  in.collision_class = CollisionClass::kPotential;
  in.delta_mm = {-0.05, -0.05};
  in.face_a = in.face_b = &zone;
  in.tolerance_mm = {-0.1, 0.1};
  in.thresholds = {-0.1, 0.1};
  in.grade = DeviationGrade::kPlanar;
  in.probability = Interval{0.25, 0.25};
  EXPECT_EQ(
      explain(in),
      "gap 50.0 µm; fake from a gap of 100.0 µm (-tolerance 100.0 µm of twice profile 0.1 mm), "
      "real above 100.0 µm (tolerance 100.0 µm): potential, P(interference) 25 %");
  in.no_inside = true;
  EXPECT_NE(explain(in).find("a part is open"), std::string::npos);
  in.delta_mm = {0.05, 1.0};
  EXPECT_EQ(explain(in),
            "the surfaces cross, but a part is open and has no inside, so the depth is not known: "
            "potential");
  in.no_inside = false;
  in.capped = true;
  EXPECT_NE(explain(in).find("work limit"), std::string::npos);
  in.delta_mm = {0.01, std::numeric_limits<double>::infinity()};
  in.capped = false;
  EXPECT_EQ(explain(in),
            "overlap at least 10.0 µm; real above 100.0 µm (twice profile 0.1 mm, mesh error: "
            "planar): potential, "
            "P(interference) 25 %");
}

TEST(Explain, AnEdgeOfPlaneFacesIsNoMeshError) {
  SurfaceBand::Face face;
  face.grade = DeviationGrade::kPlanar;
  face.tolerance_source = "±0.05 mm";
  face.tolerance_mm = {-0.05, 0.05};
  SurfaceBand::Face other;
  other.grade = DeviationGrade::kPlanar;
  ExplainInput in;
  in.collision_class = CollisionClass::kPotential;
  in.face_a = &face;
  in.face_b = &other;
  in.grade = DeviationGrade::kPlanar;
  in.tolerance_mm = face.tolerance_mm;
  in.delta_mm = {-0.15, -0.15};
  in.thresholds = {-0.1932, 0.1932};
  in.probability = Interval{0.25, 0.25};
  EXPECT_EQ(
      explain(in),
      "gap 150.0 µm; fake from a gap of 193.2 µm (-sharp edge 143.2 µm - tolerance 50.0 µm of "
      "±0.05 mm), real above 193.2 µm (sharp edge 143.2 µm + tolerance 50.0 µm): potential, "
      "P(interference) 25 %");
  // Within the accuracy of the overlap it is nothing.
  in.delta_mm = {0.01, 0.0101};
  in.thresholds = {-0.0499, 0.05};
  EXPECT_EQ(explain(in).find("sharp edge"), std::string::npos);
}

// A pin in a hole of 32 facets, corner before the middle of a facet, with the zones of a fit.
struct RoundFit {
  SurfaceBand::Face hole, shaft;
  ExplainInput in;
};

RoundFit round_fit(CollisionClass collision_class, Interval tolerance_mm, const char* hole,
                   const char* shaft, DeviationGrade grade) {
  RoundFit fit;
  fit.hole = face(hole, {});
  fit.shaft = face(shaft, {});
  fit.hole.grade = fit.shaft.grade = fit.in.grade = grade;
  fit.in.collision_class = collision_class;
  fit.in.delta_mm = {kSagitta_mm, kSagitta_mm};
  fit.in.tolerance_mm = tolerance_mm;
  fit.in.thresholds = {kSagitta_mm - tolerance_mm.hi, kSagitta_mm - tolerance_mm.lo};
  fit.in.margin_mm = 0.0005;
  return fit;
}

std::string sentence_of(RoundFit fit) {
  fit.in.face_a = &fit.shaft;
  fit.in.face_b = &fit.hole;
  return explain(fit.in);
}

void expect_in(const std::string& sentence, const std::string& part) {
  EXPECT_NE(sentence.find(part), std::string::npos) << sentence << "\n  lacks: " << part;
}
void expect_not_in(const std::string& sentence, const std::string& part) {
  EXPECT_EQ(sentence.find(part), std::string::npos) << sentence << "\n  has: " << part;
}

TEST(Explain, ARealVerdictSaysWhatItsOwnThresholdIsMadeOf) {
  EXPECT_EQ(sentence_of(round_fit(CollisionClass::kReal, {0.0005, 0.0175}, "Ø20 H7", "Ø20 p6",
                                  DeviationGrade::kDeclaredFeature)),
            "overlap 48.2 µm; fake up to 30.7 µm, real above 47.7 µm (mesh error 48.2 µm exact - "
            "least radial interference 0.5 µm of Ø20 H7/p6): real, 0.5 µm beyond");
}

TEST(Explain, APotentialVerdictSaysWhatBothThresholdsAreMadeOf) {
  RoundFit fit = round_fit(CollisionClass::kPotential, {-0.0095, 0.0075}, "Ø20 H7", "Ø20 k6",
                           DeviationGrade::kDeclaredFeature);
  fit.in.probability = Interval{0.31353, 0.31353};
  EXPECT_EQ(
      sentence_of(fit),
      "overlap 48.2 µm; fake up to 40.7 µm (mesh error 48.2 µm exact - largest radial "
      "interference 7.5 µm of Ø20 H7/k6), real above 57.7 µm (mesh error 48.2 µm exact + largest "
      "radial clearance 9.5 µm): potential, P(interference) 31.4 %");
}

TEST(Explain, AProbabilityIsToldWhereItIsKnown) {
  RoundFit fit = round_fit(CollisionClass::kPotential, {-0.0095, 0.0075}, "Ø20 H7", "Ø20 k6",
                           DeviationGrade::kDeclaredFeature);
  EXPECT_TRUE(sentence_of(fit).ends_with(": potential")) << sentence_of(fit);
  fit.in.probability = Interval{0.058, 0.0631};
  expect_in(sentence_of(fit), ": potential, P(interference) 5.8 to 6.31 %");
  fit.in.delta_mm.hi += 1.0;  // an open bracket of the overlap: the offsets may be known
  expect_in(sentence_of(fit), ": potential, P(interference) 5.8 to 6.31 %");
  fit.in.estimated = true;
  fit.in.probability = {};
  expect_in(sentence_of(fit), ": potential by estimate;");
}

// Brackets that were left open have no middle to speak of: the terms follow the thresholds.
TEST(Explain, TheTermsAddUpToTheThreshold) {
  RoundFit fit = round_fit(CollisionClass::kReal, {0.0005, 0.0175}, "Ø20 H7", "Ø20 p6",
                           DeviationGrade::kDeclaredFeature);
  fit.in.thresholds.real_above_mm = 0.0320;
  fit.hole.residual_mm = 0.0012;  // corners of the mesh off the declared surface
  const std::string text = sentence_of(fit);
  EXPECT_NE(text.find("real above 32.0 µm (mesh error 32.5 µm ±1.2 µm - least radial "
                      "interference 0.5 µm of Ø20 H7/p6)"),
            std::string::npos)
      << text;
}

// The class was decided before the other threshold was: where the search stopped is not told.
TEST(Explain, AnOpenBracketIsNoThreshold) {
  RoundFit fit = round_fit(CollisionClass::kReal, {0.0005, 0.0175}, "Ø20 H7", "Ø20 p6",
                           DeviationGrade::kDeclaredFeature);
  fit.in.thresholds.fake_below_mm = -41.8396;
  fit.in.fake_known = false;
  expect_not_in(sentence_of(fit), "fake");
  expect_in(sentence_of(fit), "real above 47.7 µm");
  fit.in.collision_class = CollisionClass::kPotential;
  fit.in.real_known = false;
  expect_not_in(sentence_of(fit), "41.8");
  expect_not_in(sentence_of(fit), "real above");
  fit.in.delta_mm.hi += 1.0;
  expect_not_in(sentence_of(fit), "real above");
}

TEST(Explain, AnEstimateNeverReadsAsGuaranteed) {
  for (const CollisionClass c :
       {CollisionClass::kReal, CollisionClass::kPotential, CollisionClass::kFake})
    for (const double width_mm : {0.0, 0.01}) {  // closed and open bracket
      RoundFit fit =
          round_fit(c, {-0.0205, -0.0035}, "Ø20 H7", "Ø20 g6", DeviationGrade::kEstimated);
      fit.in.delta_mm.lo -= width_mm;
      const auto expect_marked = [](const std::string& sentence) {
        expect_in(sentence, " by estimate");
        expect_in(sentence, "estimated, not guaranteed");
        expect_not_in(sentence, "exact");
      };
      expect_marked(sentence_of(fit));
      fit.in.thresholds = {0.0035, 0.0205};  // an estimate of no error is an estimate
      expect_marked(sentence_of(fit));
      // The worse grade of the other face does not hide it.
      fit.in.grade = fit.hole.grade = DeviationGrade::kNominal;
      expect_marked(sentence_of(fit));
      fit.shaft.grade = DeviationGrade::kNominal;
      expect_not_in(sentence_of(fit), "by estimate");
    }
}

TEST(Explain, RecognizedSurfacesNameTheirResidual) {
  RoundFit fit = round_fit(CollisionClass::kFake, {-0.0205, -0.0035}, "Ø20 H7", "Ø20 g6",
                           DeviationGrade::kRecognizedFeature);
  fit.hole.residual_mm = 0.0012;
  fit.shaft.residual_mm = 0.0003;
  expect_in(sentence_of(fit), "surfaces recognized in the mesh, residual 1.5 µm");
  fit.shaft.grade = DeviationGrade::kDeclaredFeature;  // a declared one is another matter
  expect_in(sentence_of(fit), "residual 1.2 µm");
  fit.hole.residual_mm = 1e-8;
  expect_in(sentence_of(fit), "residual below 0.1 µm");
  fit.in.delta_mm.lo -= 0.01;
  expect_in(sentence_of(fit), "residual below 0.1 µm");
}

TEST(Explain, TolerancesOnAMeshTakenForTheSurfaceSaySo) {
  expect_in(sentence_of(round_fit(CollisionClass::kFake, {-0.02, -0.01}, "Ø20 H7", "Ø20 g6",
                                  DeviationGrade::kNominal)),
            "mesh taken for the surface (nominal)");
  expect_not_in(sentence_of(round_fit(CollisionClass::kFake, {-0.02, -0.01}, "Ø20 H7", "Ø20 g6",
                                      DeviationGrade::kDeclaredFeature)),
                "nominal");
}

TEST(Explain, PositionsAndSeveralStatementsAreNamed) {
  const auto of = [](const char* hole, const char* shaft) {
    return sentence_of(round_fit(CollisionClass::kPotential, {-0.07, 0.05}, hole, shaft,
                                 DeviationGrade::kDeclaredFeature));
  };
  expect_in(of("Ø20 H7, position Ø0.1 mm", "Ø20 g6"), "of Ø20 H7/g6 and position Ø0.1 mm)");
  expect_in(of("Ø20 H7, position Ø0.1 mm", "Ø20 g6, position Ø0.1 mm"),
            "of Ø20 H7/g6 and twice position Ø0.1 mm)");
  expect_in(of("position Ø0.1 mm", ""), "of position Ø0.1 mm)");
  expect_in(of("Ø20 H7 and ±0.005 mm", "Ø20 g6"), "of Ø20 g6 and Ø20 H7 and ±0.005 mm)");
}

}  // namespace
}  // namespace mortise
