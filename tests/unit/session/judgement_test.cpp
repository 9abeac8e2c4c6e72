#include "common/session/tick/judgement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "tests/unit/depth/depth_bands.h"

namespace mortise {
namespace {

using namespace shapes;

Part part_of(std::uint32_t id, const SolidPtr& solid, const SurfaceBand& band) {
  Part part;
  part.id = PartId{id};
  part.solid = solid;
  part.band = band;
  return part;
}

struct FitPair {
  explicit FitPair(const std::string& code) {
    const FitOffsets offsets = fit_offsets(code, 10.0);
    const SolidPtr shaft = solid(peg({10, -5, 15, 32, 1, std::numbers::pi / 32}));
    const SolidPtr plate = solid(ring({10, 0, 20, 32, 1, 0}, 20));
    a = part_of(1, shaft,
                cylinder_band(shaft, 10, false, offsets.shaft_mm, "Ø20 " + code.substr(3)));
    b = part_of(2, plate,
                cylinder_band(plate, 10, true, offsets.hole_mm, "Ø20 " + code.substr(0, 2)));
  }
  Judgement judge(bool want_gpd = true) const {
    JudgementQuery query;
    query.a = &a;
    query.b = &b;
    query.motion_a = query.motion_b = still_motion(Pose());
    query.want_gpd = want_gpd;
    CcdScratch scratch;
    return judge_pair(query, scratch);
  }
  Part a, b;
};

// A thread keeps what it worked out of a part: a part whose faces are stated anew is another one.
TEST(Judgement, APartStatedAnewIsJudgedAsInAFreshThread) {
  FitPair pair("H7/g6");
  const SurfaceBand of_shaft = pair.a.band, of_plate = pair.b.band;
  // The same statements, numbered the other way round.
  for (SurfaceBand* band : {&pair.a.band, &pair.b.band}) {
    std::swap(band->faces[0], band->faces[1]);
    for (std::size_t t = 0; t < band->face_of_triangle.size(); ++t)
      band->face_of_triangle.set(t, static_cast<std::uint16_t>(1 - band->face_of_triangle[t]));
  }
  EXPECT_EQ(pair.judge().verdicts[0].collision_class, CollisionClass::kFake);
  pair.a.band = of_shaft;
  pair.b.band = of_plate;
  const Judgement here = pair.judge();
  Judgement fresh;
  std::thread([&] { fresh = pair.judge(); }).join();
  ASSERT_EQ(here.verdicts.size(), fresh.verdicts.size());
  ASSERT_EQ(here.verdicts.size(), 1U);
  EXPECT_EQ(here.verdicts[0].collision_class, CollisionClass::kFake);
  EXPECT_EQ(here.verdicts[0].explanation, fresh.verdicts[0].explanation);
  EXPECT_EQ(here.overlap.evaluations, fresh.overlap.evaluations);
}

TEST(Judgement, NamesTheSamePartTwiceAndAPartWithinAnother) {
  const SolidPtr block = solid(box({10, 10, 10})), pin = solid(box({1, 1, 1}));
  const auto said = [](const SolidPtr& a, const SolidPtr& b, const Vec3& at) {
    Part part_a = part_of(1, a, nominal_band()), part_b = part_of(2, b, nominal_band());
    part_a.name = "block";
    part_b.name = "other";
    JudgementQuery query;
    query.a = &part_a;
    query.b = &part_b;
    query.motion_a = still_motion(Pose());
    query.motion_b = still_motion(Pose::translation(at));
    CcdScratch scratch;
    const Judgement judgement = judge_pair(query, scratch);
    return judgement.verdicts.empty() ? "" : judgement.verdicts[0].explanation;
  };
  const auto says = [&](const std::string& text, const std::string& what) {
    EXPECT_NE(text.find(what), std::string::npos) << text;
  };
  says(said(block, block, Vec3::Zero()), "; the same part twice in one place");
  says(said(block, block, {0.01, 0, 0}), "; the same part twice, 10.0 µm apart");
  says(said(block, pin, {3, 2, 1}), "; other lies wholly inside block");
  EXPECT_EQ(said(block, block, {15, 0, 0}).find("same part"), std::string::npos);
  EXPECT_EQ(said(block, pin, {10, 2, 1}).find("inside"), std::string::npos);
}

TEST(Judgement, FakeFitInOneSentence) {
  const Judgement judgement = FitPair("H7/g6").judge();
  ASSERT_EQ(judgement.verdicts.size(), 1U);
  const Verdict& v = judgement.verdicts[0];
  EXPECT_EQ(v.collision_class, CollisionClass::kFake);
  EXPECT_NEAR(v.delta_mm.lo, 0.048152733, 1e-9);
  EXPECT_NEAR(v.fake_below_mm, 0.051652733, 1e-6);
  EXPECT_NEAR(v.real_above_mm, 0.068652733, 1e-6);
  EXPECT_NEAR(v.margin_mm, 0.0035, 1e-6);
  EXPECT_EQ(v.probability, 0.0);
  EXPECT_EQ(v.grade, DeviationGrade::kDeclaredFeature);
  EXPECT_EQ(v.face_a, "shaft");
  EXPECT_EQ(v.face_b, "bore");
  EXPECT_EQ(v.shape_a, FaceShape::kConvex);
  EXPECT_EQ(v.shape_b, FaceShape::kConcave);
  EXPECT_EQ(v.gpd_mm, Interval{});  // fake: nobody needs a way out
  for (const char* part : {"48.2", "51.7", "68.7", "Ø20 H7/g6", "fake", "3.5"})
    EXPECT_NE(v.explanation.find(part), std::string::npos) << part << " in: " << v.explanation;
}

TEST(Judgement, PotentialAndRealFits) {
  const Judgement k6 = FitPair("H7/k6").judge();
  ASSERT_FALSE(k6.verdicts.empty());
  EXPECT_EQ(k6.verdicts[0].collision_class, CollisionClass::kPotential);
  EXPECT_NEAR(k6.verdicts[0].probability, 0.31353, 0.02);
  const Judgement p6 = FitPair("H7/p6").judge();
  ASSERT_FALSE(p6.verdicts.empty());
  const Verdict& v = p6.verdicts[0];
  EXPECT_EQ(v.collision_class, CollisionClass::kReal);
  EXPECT_TRUE(v.has_witness);
  EXPECT_EQ(v.probability, 1.0);
  EXPECT_GT(v.gpd_mm.lo, 0.0);
  EXPECT_GE(v.gpd_mm.hi, v.gpd_mm.lo);
}

// Sizes and axes are drawn, mesh errors are not.
TEST(Judgement, AProbabilityIsKnownOnlyOfKnownSurfaces) {
  const auto p_of = [](FitPair& pair) {
    const Judgement judgement = pair.judge();
    EXPECT_EQ(judgement.verdicts.size(), 1U);
    const Verdict& v = judgement.verdicts.at(0);
    EXPECT_EQ(v.collision_class, CollisionClass::kPotential) << v.explanation;
    EXPECT_EQ(has_probability(v), v.explanation.find("P(") != std::string::npos) << v.explanation;
    return v.probability;
  };
  FitPair pair("H7/k6");
  EXPECT_NEAR(p_of(pair), 0.31353, 0.001);
  FitPair refused = pair;
  refused.a.band.faces[1].grade = DeviationGrade::kEstimated;
  EXPECT_EQ(p_of(refused), kProbabilityUnknown);
  // Facets taken for the shaft, and nothing but a bound of their error.
  for (const DeviationGrade grade : {DeviationGrade::kNominal, DeviationGrade::kDeclaredChord}) {
    FitPair faceted = pair;
    faceted.a.band = uniform_band({}, {-0.06, 0.01}, grade);
    EXPECT_EQ(p_of(faceted), kProbabilityUnknown);
  }
  FitPair untold = pair;  // nothing declared, recognized to 2 µm
  for (SurfaceBand* band : {&untold.a.band, &untold.b.band}) {
    band->faces[1].tolerance_mm = {};
    band->faces[1].grade = DeviationGrade::kRecognizedFeature;
    band->faces[1].residual_mm = 0.001;
  }
  EXPECT_EQ(p_of(untold), kProbabilityUnknown);
}

TEST(Judgement, APositionIsDrawnWhereTwoCylindersAreParallel) {
  FitPair pair("H7/g6");
  SurfaceBand::Face& bore = pair.b.band.faces[1];
  bore.position_mm = 0.03;
  bore.tolerance_mm = bore.tolerance_mm + Interval{-0.015, 0.015};
  pair.b.band.largest_offset_mm = 0.015;
  const Judgement drawn = pair.judge();
  ASSERT_EQ(drawn.verdicts.size(), 1U);
  // Radial clearance 3.5 to 20.5 µm, sigma of the sizes 2.06, of both components of the axis 5 µm.
  const double c = 12.0, s = std::hypot(10.5, 6.5) / 6, both = std::hypot(s, 5.0);
  const double p = 5.0 / both * std::exp(-0.5 * c * c / both / both);
  EXPECT_NEAR(drawn.verdicts[0].probability, p, 0.002) << drawn.verdicts[0].explanation;
  bore.position_grows = true;
  EXPECT_EQ(pair.judge().verdicts.at(0).probability, kProbabilityUnknown);
}

TEST(Judgement, NominalBlocksHaveGpdOnlyWhenAsked) {
  FitPair pair("H7/g6");
  const SolidPtr cube = solid(box({.5, .5, .5}));
  pair.a = part_of(1, cube, nominal_band());
  pair.b = part_of(2, solid(box({.5, .5, .5}, {.9, .13, .07})), nominal_band());
  const Judgement with = pair.judge(true), without = pair.judge(false);
  ASSERT_EQ(with.verdicts.size(), 1U);
  EXPECT_EQ(with.verdicts[0].collision_class, CollisionClass::kReal);
  EXPECT_EQ(with.verdicts[0].grade, DeviationGrade::kNominal);
  EXPECT_NEAR(with.verdicts[0].gpd_mm.lo, 0.1, 1e-9);
  EXPECT_NEAR(with.verdicts[0].gpd_mm.hi, 0.1, 0.003);
  EXPECT_EQ(without.verdicts[0].gpd_mm, Interval{});
}

}  // namespace
}  // namespace mortise
