#include "common/evaluation/verdict.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/evaluation/tolerance.h"
#include "tests/unit/evaluation/fit_faces.h"

namespace mortise {
namespace {

Result<FitStatement> fit_of(const std::string& code, double nominal_mm, double hole_radius_mm,
                            double shaft_radius_mm, double residual_mm = 0.0) {
  static Surface hole, shaft;
  hole = cylinder(hole_radius_mm, true);
  shaft = cylinder(shaft_radius_mm, false);
  return fit_statement(code, nominal_mm, {&hole, residual_mm, "plate.bore"},
                       {&shaft, residual_mm, "pin.journal"});
}

TEST(Tolerance, AFitModelledAtNominal) {
  const auto fit = fit_of("H7/g6", 0.0, 10.0, 10.0);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->text, "Ø20 H7/g6");
  EXPECT_NEAR(fit->a.offset_mm.lo, -0.0105, 1e-12);  // hole: -ES/2
  EXPECT_NEAR(fit->a.offset_mm.hi, 0.0, 1e-12);
  EXPECT_NEAR(fit->b.offset_mm.lo, -0.0100, 1e-12);  // shaft: ei/2
  EXPECT_NEAR(fit->b.offset_mm.hi, -0.0035, 1e-12);
  EXPECT_EQ(fit->a.source, "Ø20 H7");
  EXPECT_EQ(fit->b.source, "Ø20 g6");
}

// Wherever the mesh was modelled, the real surface lies at the same radii.
TEST(Tolerance, AFitModelledAtAnySizeWithinItsLimitsMeansTheSameRadii) {
  for (const double hole_mm : {10.0, 10.005, 10.0105})
    for (const double shaft_mm : {10.0, 9.99, 9.9965}) {
      const auto fit = fit_of("H7/g6", 20.0, hole_mm, shaft_mm);
      ASSERT_TRUE(fit) << hole_mm << " " << shaft_mm << fit.error().text;
      EXPECT_NEAR(hole_mm - fit->a.offset_mm.lo, 10.0105, 1e-12);
      EXPECT_NEAR(hole_mm - fit->a.offset_mm.hi, 10.0, 1e-12);
      EXPECT_NEAR(shaft_mm + fit->b.offset_mm.lo, 9.99, 1e-12);
      EXPECT_NEAR(shaft_mm + fit->b.offset_mm.hi, 9.9965, 1e-12);
    }
}

TEST(Tolerance, AModelledSizeOutsideTheLimitsIsRefused) {
  const auto expect_refused = [](const Result<FitStatement>& fit, const std::string& says) {
    ASSERT_FALSE(fit);
    EXPECT_NE(fit.error().text.find(says), std::string::npos) << fit.error().text;
  };
  expect_refused(fit_of("H7/g6", 20.0, 10.02, 10.0), "plate.bore: modelled diameter 20.04 mm");
  expect_refused(fit_of("H7/g6", 20.0, 10.0, 9.9), "20 g6");
  expect_refused(fit_of("H7/g6", 0.0, 10.0, 9.99), "add nominal");
  EXPECT_TRUE(fit_of("H7/g6", 20.0, 10.0110, 10.0, 0.0006));  // up to the deviation
  Surface bore = cylinder(10.0, true), other = cylinder(10.0, true), plane;
  plane.kind = SurfaceKind::kPlane;
  expect_refused(fit_statement("H7/g6", 20.0, {&bore, 0, "a.x"}, {&other, 0, "b.y"}),
                 "a.x is a hole and b.y is a hole");
  expect_refused(fit_statement("H7/g6", 20.0, {&bore, 0, "a.x"}, {&plane, 0, "b.y"}),
                 "no diameter");
  const auto shaft_first = fit_statement("H7/g6", 20.0, {&bore, 0, "a.x"}, {&plane, 0, "b.y"});
  EXPECT_FALSE(shaft_first);
  EXPECT_FALSE(iso_statement("g6", 20.0, bore, 0.0));  // a shaft's class on a hole
  EXPECT_TRUE(iso_statement("H7", 0.0, bore, 0.0));
}

// evaluation/README.md, section 5: half a phase turned, R 10, 32 facets: overlap 48.152733 um, all
// of it mesh error of the hole's facet at its middle.
struct Case63 {
  const char* code;
  double certain_mm, possible_mm;
  CollisionClass expected;
};
TEST(Verdict, PositionDependentErrorDecides) {
  constexpr Case63 kCases[] = {{"H7/g6", -0.0205, -0.0035, CollisionClass::kFake},
                               {"H7/h6", -0.0170, 0.0, CollisionClass::kFake},
                               {"H7/k6", -0.0095, 0.0075, CollisionClass::kPotential},
                               {"H7/n6", -0.0030, 0.0140, CollisionClass::kPotential},
                               {"H7/p6", 0.0005, 0.0175, CollisionClass::kReal},
                               {"H8/f7", -0.0370, -0.0100, CollisionClass::kFake}};
  for (const Case63& c : kCases) {
    const auto fit = fit_of(c.code, 20.0, 10.0, 10.0);
    ASSERT_TRUE(fit);
    const Interval tolerance = fit->a.offset_mm + fit->b.offset_mm;
    const double exact = kSagitta_mm - kSagitta_mm;  // overlap + e(x) of the hole
    EXPECT_NEAR(exact + tolerance.lo, c.certain_mm, 1e-9) << c.code;
    EXPECT_NEAR(exact + tolerance.hi, c.possible_mm, 1e-9) << c.code;
    ClassifyInput input;
    input.delta_mm = {kSagitta_mm, kSagitta_mm};
    input.certain_mm = {exact + tolerance.lo, exact + tolerance.lo};
    input.possible_mm = {exact + tolerance.hi, exact + tolerance.hi};
    input.has_witness = input.certain_mm.lo > 0.0;
    EXPECT_EQ(classify(input), c.expected) << c.code;
    const Thresholds t = thresholds_of(input.delta_mm, input.certain_mm, input.possible_mm);
    EXPECT_EQ(input.delta_mm.lo > t.real_above_mm, c.expected == CollisionClass::kReal) << c.code;
    EXPECT_EQ(input.delta_mm.hi <= t.fake_below_mm + 1e-15, c.expected == CollisionClass::kFake)
        << c.code;
  }
}

TEST(Verdict, AGlobalBoundCannotTellWhatTheExactErrorTells) {
  const auto fit = fit_of("H7/g6", 20.0, 10.0, 10.0);
  const Interval both{-kSagitta_mm, kSagitta_mm};  // hole [-s, 0], shaft [0, s]
  const Interval all = fit->a.offset_mm + fit->b.offset_mm + both;
  EXPECT_NEAR(kSagitta_mm + all.lo, -0.0205, 1e-9);
  EXPECT_NEAR(kSagitta_mm + all.hi, 0.0928, 1e-4);
  ClassifyInput input;
  input.delta_mm = {kSagitta_mm, kSagitta_mm};
  input.certain_mm = {kSagitta_mm + all.lo, kSagitta_mm + all.lo};
  input.possible_mm = {kSagitta_mm + all.hi, kSagitta_mm + all.hi};
  EXPECT_EQ(classify(input), CollisionClass::kPotential);
}

// Every ordering of the ends against zero, with the rule written out once more.
TEST(Verdict, EveryOrderingOfTheEnds) {
  const double values[] = {-2.0, -1.0, 0.0, 1.0, 2.0};
  int seen[4] = {0, 0, 0, 0};
  for (const double d_lo : values)
    for (const double d_hi : values)
      for (const double c_lo : values)
        for (const double c_hi : values)
          for (const double p_lo : values)
            for (const double p_hi : values)
              for (const int flags : {0, 1, 2, 3}) {
                if (d_lo > d_hi || c_lo > c_hi || p_lo > p_hi || c_lo > p_lo || c_hi > p_hi)
                  continue;
                const ClassifyInput in{
                    {d_lo, d_hi}, {c_lo, c_hi}, {p_lo, p_hi}, (flags & 1) != 0, (flags & 2) != 0};
                CollisionClass expected = CollisionClass::kPotential;
                if (p_hi <= 0.0 && d_hi <= 0.0)
                  expected = CollisionClass::kNone;
                else if (in.no_inside)
                  expected = CollisionClass::kPotential;
                else if (p_hi <= 0.0)
                  expected = CollisionClass::kFake;
                else if (c_lo > 0.0 && in.has_witness)
                  expected = CollisionClass::kReal;
                EXPECT_EQ(classify(in), expected);
                ++seen[static_cast<int>(expected)];
                const Thresholds t = thresholds_of(in.delta_mm, in.certain_mm, in.possible_mm);
                EXPECT_LE(t.fake_below_mm, t.real_above_mm);
                EXPECT_EQ(d_lo > t.real_above_mm, c_lo > 0.0);
                EXPECT_EQ(d_hi <= t.fake_below_mm, p_hi <= 0.0);
              }
  for (const int count : seen) EXPECT_GT(count, 0);
}

TEST(Verdict, PlanarBlocksWithProfileZones) {
  const auto class_at = [](double delta_mm) {
    ClassifyInput input;
    input.delta_mm = {delta_mm, delta_mm};
    input.certain_mm = {delta_mm - 0.1, delta_mm - 0.1};
    input.possible_mm = {delta_mm + 0.1, delta_mm + 0.1};
    input.has_witness = delta_mm > 0.1;
    return classify(input);
  };
  EXPECT_EQ(class_at(0.2), CollisionClass::kReal);
  EXPECT_EQ(class_at(0.05), CollisionClass::kPotential);
  EXPECT_EQ(class_at(-0.05), CollisionClass::kPotential);
  EXPECT_EQ(class_at(-0.2), CollisionClass::kNone);
}

TEST(Verdict, ABracketHasItsLowerEndFirst) {
  ClassifyInput input;
  input.certain_mm = {0.2, 0.1};
  EXPECT_DEATH(classify(input), "lower ends first");
  input.certain_mm = {0.0, std::nan("")};
  EXPECT_DEATH(classify(input), "lower ends first");
}

}  // namespace
}  // namespace mortise
