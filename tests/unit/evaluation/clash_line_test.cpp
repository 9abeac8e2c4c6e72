#include "common/evaluation/clash_line.h"

#include <gtest/gtest.h>

#include <limits>

#include "common/evaluation/threshold_text.h"
#include "common/messages/length_text.h"

namespace mortise {
namespace {

Verdict verdict_of(CollisionClass collision_class, double margin_mm, const char* explanation) {
  Verdict v;
  v.collision_class = collision_class;
  v.delta_mm = {0.0482, 0.0482};
  v.real_above_mm = 0.0477;
  v.margin_mm = margin_mm;
  v.probability = 0.31353;
  v.explanation = explanation;
  return v;
}

TEST(LengthText, IsMicrometresBelowAMillimetre) {
  EXPECT_EQ(length_text(0.0005), "0.5 µm");
  EXPECT_EQ(length_text(-0.1), "-100.0 µm");
  EXPECT_EQ(length_text(-1e-9), "0.0 µm");
  EXPECT_EQ(length_text(0.99994), "999.9 µm");
  EXPECT_EQ(length_text(0.99996), "1.000 mm");
  EXPECT_EQ(length_text(-41.8396), "-41.840 mm");
  EXPECT_EQ(length_text(std::numeric_limits<double>::infinity()), "unbounded");
  EXPECT_EQ(length_text(std::numeric_limits<double>::max()).substr(0, 5), "17976");
}

TEST(LengthText, ABracketSaysItsUnitOnce) {
  EXPECT_EQ(range_text({0.0482, 0.0501}), "48.2 to 50.1 µm");
  EXPECT_EQ(range_text({0.0482, 25.0}), "48.2 µm to 25.000 mm");
  EXPECT_EQ(range_text({2.0, 25.0}), "2.000 to 25.000 mm");
  EXPECT_EQ(range_text({0.0482, 0.04825}), "48.2 µm");
  EXPECT_EQ(range_text({20.0, 20.0002}), "20.000 mm");
  EXPECT_EQ(range_text({0.0482, std::numeric_limits<double>::infinity()}), "at least 48.2 µm");
}

TEST(ThresholdText, BelowZeroIsAGap) {
  EXPECT_EQ(fake_text(0.0517), "fake up to 51.7 µm");
  EXPECT_EQ(fake_text(-0.003), "fake from a gap of 3.0 µm");
  EXPECT_EQ(fake_text(-1e-7), "fake up to 0.0 µm");
  EXPECT_EQ(real_text(-0.003), "real below a gap of 3.0 µm");
}

TEST(ThresholdText, WhatTheSentenceLeavesOutIsNotKnown) {
  Verdict v =
      verdict_of(CollisionClass::kReal, 0.0005, "overlap 48.2 µm; real above 47.7 µm: real");
  v.fake_below_mm = -41.8396;
  EXPECT_FALSE(states_fake(v));
  EXPECT_TRUE(states_real(v));
  v.fake_below_mm = 0.0;  // nothing is declared
  EXPECT_TRUE(states_fake(v));
}

TEST(ThresholdText, AProbabilityHasTheDigitsThatAreKnown) {
  EXPECT_EQ(probability_text({0.31353, 0.31353}), "P(interference) 31.4 %");
  EXPECT_EQ(probability_text({0.3135, 0.3144}), "P(interference) 31.4 %");
  EXPECT_EQ(probability_text({0.058, 0.0631}), "P(interference) 5.8 to 6.31 %");
  EXPECT_EQ(probability_text({3e-9, 3e-9}), "P(interference) below 0.01 %");
  EXPECT_EQ(probability_text({1e-5, 0.002}), "P(interference) below 0.2 %");
  EXPECT_EQ(probability_text({0.999994, 0.999994}), "P(interference) above 99.9 %");
  EXPECT_EQ(probability_text({0.97, 1.0}), "P(interference) above 97 %");
}

TEST(ClashLine, SaysTheClassFirst) {
  Verdict v = verdict_of(CollisionClass::kReal, 0.0005, "of Ø20 H7/p6): real");
  EXPECT_EQ(clash_line({"cover", "bearing_out_upper", &v, "Ø20 H7/p6", 0, ""}),
            "REAL  cover × bearing_out_upper   0.5 µm beyond H7/p6");
  EXPECT_EQ(clash_line({"cover", "pin", &v, "Ø20 H7/p6", 7, "clash 4 by ann"}),
            "REAL  cover × pin   0.5 µm beyond H7/p6, +7 places   clash 4 by ann");
  EXPECT_EQ(clash_line({"a", "b", &v, "Ø30 H7/g6", 1, ""}),  // other faces than those of the fit
            "REAL  a × b   0.5 µm beyond tolerance and mesh error, +1 place");
  const Verdict of_zone = verdict_of(CollisionClass::kReal, 0.0005, "of surface ±0.02 mm): real");
  EXPECT_EQ(clash_line({"a", "b", &of_zone, "±0.02 mm", 0, ""}),
            "REAL  a × b   0.5 µm beyond ±0.02 mm");
  v.real_above_mm = 0.0;
  EXPECT_EQ(clash_line({"a", "b", &v, "", 0, ""}), "REAL  a × b   0.5 µm deep");
  v.delta_mm.hi = 3.0;
  EXPECT_EQ(clash_line({"a", "b", &v, "", 0, ""}), "REAL  a × b   at least 0.5 µm deep");
}

TEST(ClashLine, OfEveryClass) {
  const Verdict fake = verdict_of(CollisionClass::kFake, 0.0035, "of Ø20 H7/g6): fake");
  EXPECT_EQ(clash_line({"a", "b", &fake, "Ø20 H7/g6", 0, ""}),
            "FAKE  a × b   3.5 µm to spare in H7/g6");
  const Verdict may = verdict_of(CollisionClass::kPotential, 0.0035, "of Ø20 H7/k6): potential");
  EXPECT_EQ(clash_line({"a", "b", &may, "Ø20 H7/k6", 0, ""}),
            "POTENTIAL  a × b   P(interference) 31.4 % in H7/k6");
  const Verdict about = verdict_of(CollisionClass::kPotential, 0.0035,
                                   "potential, P(interference) 30 to 33 %; recognized");
  EXPECT_EQ(clash_line({"a", "b", &about, "", 0, ""}),
            "POTENTIAL  a × b   P(interference) 30 to 33 %");
  const Verdict open = verdict_of(CollisionClass::kPotential, 0.0,
                                  "the surfaces cross, but a part is open and has no inside");
  EXPECT_EQ(clash_line({"a", "b", &open, "", 0, ""}),
            "POTENTIAL  a × b   depth not known, a part is open");
}

TEST(ClashLine, WithoutAProbabilityItSaysHowDeep) {
  Verdict v = verdict_of(CollisionClass::kPotential, 0.0, "real above 96.3 µm: potential");
  v.probability = kProbabilityUnknown;
  v.real_above_mm = 0.0963;
  const auto said = [&] { return clash_line({"a", "b", &v, "", 0, ""}).substr(20); };
  EXPECT_EQ(said(), "overlap 48.2 µm, real above 96.3 µm");
  v.explanation = "potential";  // where the search stopped
  EXPECT_EQ(said(), "overlap 48.2 µm");
  v.delta_mm.hi = 3.0;
  EXPECT_EQ(said(), "overlap at least 48.2 µm");
  v.delta_mm.lo = -1.0;
  EXPECT_EQ(said(), "overlap at most 3.000 mm");
  v.delta_mm = {-0.02, -0.02};
  v.explanation = "real above 96.3 µm: potential by estimate; mesh error estimated";
  EXPECT_EQ(said(), "gap 20.0 µm, by estimate");
  v.delta_mm.lo = -0.5;
  EXPECT_EQ(said(), "gap at least 20.0 µm, by estimate");
  v.explanation = "a part is open here, so what is inside it is not known: potential";
  EXPECT_EQ(said(), "depth not known, a part is open");
}

TEST(ClashLine, ColumnsOfAListAreAligned) {
  const Verdict real = verdict_of(CollisionClass::kReal, 0.0005, "");
  const Verdict fake = verdict_of(CollisionClass::kPotential, 0.0035, "");
  const std::vector<ClashLine> rows{{"a", "b", &real, "", 0, ""}, {"Käfig", "Ø", &fake, "", 0, ""}};
  EXPECT_EQ(clash_lines(rows), (std::vector<std::string>{
                                   "REAL       a × b       0.5 µm beyond tolerance and mesh error",
                                   "POTENTIAL  Käfig × Ø   P(interference) 31.4 %"}));
}

TEST(ClashLine, HasTheSameFormForOtherWords) {
  EXPECT_EQ(pair_line("ENDED", "a", "b", "was real for 1.8 s"),
            "ENDED  a × b   was real for 1.8 s");
  for (const std::size_t length : {30U, 60U, 500U}) {
    const std::string name(length, 'x');
    const std::string text = pair_line("ENDED", name, name, "was real for 1.8 s   clash 1");
    EXPECT_LE(columns_of(text), kClashLineColumns) << text;
    EXPECT_TRUE(text.ends_with("   was real for 1.8 s   clash 1")) << text;
  }
}

TEST(ClashLine, IsColouredAtTheWordOfItsClass) {
  EXPECT_EQ(coloured_line("REAL  a × b", CollisionClass::kReal), "\033[31mREAL\033[0m  a × b");
  EXPECT_EQ(coloured_line("FAKE  a × b", CollisionClass::kFake), "\033[34mFAKE\033[0m  a × b");
  EXPECT_EQ(coloured_line("ENDED", CollisionClass::kNone), "\033[2mENDED\033[0m");
}

TEST(ClashLine, IsNeverLongerThanATerminal) {
  const Verdict v = verdict_of(CollisionClass::kPotential, 1e300, "of a fit with a long name");
  for (const std::size_t length : {1U, 30U, 60U, 500U})
    for (const char* one : {"x", "ü", "漢"}) {
      std::string name;
      for (std::size_t i = 0; i < length; ++i) name += one;
      for (const ClashLine& line :
           {ClashLine{name, "b", &v, "", 0, ""}, ClashLine{"a", name, &v, "", 3, name},
            ClashLine{name, name, &v, "a fit with a long name", 12345, name}}) {
        const std::string text = clash_line(line);
        EXPECT_LE(columns_of(text), kClashLineColumns) << text;
        EXPECT_NE(text.find(" × "), std::string::npos) << text;
      }
    }
}

}  // namespace
}  // namespace mortise
