#include "common/evaluation/iso286.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace mortise {
namespace {

constexpr std::array<double, 13> kStepEnds_mm{3,   6,   10,  18,  30,  50, 80,
                                              120, 180, 250, 315, 400, 500};

double lower_um(const std::string& code, double nominal_mm) {
  const auto limits = iso286_limits(code, nominal_mm);
  EXPECT_TRUE(limits) << code << " " << nominal_mm;
  return limits ? limits->deviation_mm.lo * 1e3 : NAN;
}
double upper_um(const std::string& code, double nominal_mm) {
  const auto limits = iso286_limits(code, nominal_mm);
  EXPECT_TRUE(limits) << code << " " << nominal_mm;
  return limits ? limits->deviation_mm.hi * 1e3 : NAN;
}

std::string class_of(const char* letter, int grade) {
  return std::string(letter).append(std::to_string(grade));
}

// Limits as the standard's second part prints them, class by class and step by step: written down
// apart from the library's tables, which are in the form of the first part.
struct PrintedClass {
  std::string code;
  std::array<std::array<double, 2>, 13> upper_lower_um;
};
const std::vector<PrintedClass>& printed() {
  static const std::vector<PrintedClass> classes{{"H7",
                                                  {{{10, 0},
                                                    {12, 0},
                                                    {15, 0},
                                                    {18, 0},
                                                    {21, 0},
                                                    {25, 0},
                                                    {30, 0},
                                                    {35, 0},
                                                    {40, 0},
                                                    {46, 0},
                                                    {52, 0},
                                                    {57, 0},
                                                    {63, 0}}}},
                                                 {"H6",
                                                  {{{6, 0},
                                                    {8, 0},
                                                    {9, 0},
                                                    {11, 0},
                                                    {13, 0},
                                                    {16, 0},
                                                    {19, 0},
                                                    {22, 0},
                                                    {25, 0},
                                                    {29, 0},
                                                    {32, 0},
                                                    {36, 0},
                                                    {40, 0}}}},
                                                 {"H11",
                                                  {{{60, 0},
                                                    {75, 0},
                                                    {90, 0},
                                                    {110, 0},
                                                    {130, 0},
                                                    {160, 0},
                                                    {190, 0},
                                                    {220, 0},
                                                    {250, 0},
                                                    {290, 0},
                                                    {320, 0},
                                                    {360, 0},
                                                    {400, 0}}}},
                                                 {"h9",
                                                  {{{0, -25},
                                                    {0, -30},
                                                    {0, -36},
                                                    {0, -43},
                                                    {0, -52},
                                                    {0, -62},
                                                    {0, -74},
                                                    {0, -87},
                                                    {0, -100},
                                                    {0, -115},
                                                    {0, -130},
                                                    {0, -140},
                                                    {0, -155}}}},
                                                 {"g6",
                                                  {{{-2, -8},
                                                    {-4, -12},
                                                    {-5, -14},
                                                    {-6, -17},
                                                    {-7, -20},
                                                    {-9, -25},
                                                    {-10, -29},
                                                    {-12, -34},
                                                    {-14, -39},
                                                    {-15, -44},
                                                    {-17, -49},
                                                    {-18, -54},
                                                    {-20, -60}}}},
                                                 {"f7",
                                                  {{{-6, -16},
                                                    {-10, -22},
                                                    {-13, -28},
                                                    {-16, -34},
                                                    {-20, -41},
                                                    {-25, -50},
                                                    {-30, -60},
                                                    {-36, -71},
                                                    {-43, -83},
                                                    {-50, -96},
                                                    {-56, -108},
                                                    {-62, -119},
                                                    {-68, -131}}}},
                                                 {"e8",
                                                  {{{-14, -28},
                                                    {-20, -38},
                                                    {-25, -47},
                                                    {-32, -59},
                                                    {-40, -73},
                                                    {-50, -89},
                                                    {-60, -106},
                                                    {-72, -126},
                                                    {-85, -148},
                                                    {-100, -172},
                                                    {-110, -191},
                                                    {-125, -214},
                                                    {-135, -232}}}},
                                                 {"d9",
                                                  {{{-20, -45},
                                                    {-30, -60},
                                                    {-40, -76},
                                                    {-50, -93},
                                                    {-65, -117},
                                                    {-80, -142},
                                                    {-100, -174},
                                                    {-120, -207},
                                                    {-145, -245},
                                                    {-170, -285},
                                                    {-190, -320},
                                                    {-210, -350},
                                                    {-230, -385}}}},
                                                 {"k6",
                                                  {{{6, 0},
                                                    {9, 1},
                                                    {10, 1},
                                                    {12, 1},
                                                    {15, 2},
                                                    {18, 2},
                                                    {21, 2},
                                                    {25, 3},
                                                    {28, 3},
                                                    {33, 4},
                                                    {36, 4},
                                                    {40, 4},
                                                    {45, 5}}}},
                                                 {"m6",
                                                  {{{8, 2},
                                                    {12, 4},
                                                    {15, 6},
                                                    {18, 7},
                                                    {21, 8},
                                                    {25, 9},
                                                    {30, 11},
                                                    {35, 13},
                                                    {40, 15},
                                                    {46, 17},
                                                    {52, 20},
                                                    {57, 21},
                                                    {63, 23}}}},
                                                 {"n6",
                                                  {{{10, 4},
                                                    {16, 8},
                                                    {19, 10},
                                                    {23, 12},
                                                    {28, 15},
                                                    {33, 17},
                                                    {39, 20},
                                                    {45, 23},
                                                    {52, 27},
                                                    {60, 31},
                                                    {66, 34},
                                                    {73, 37},
                                                    {80, 40}}}},
                                                 {"p6",
                                                  {{{12, 6},
                                                    {20, 12},
                                                    {24, 15},
                                                    {29, 18},
                                                    {35, 22},
                                                    {42, 26},
                                                    {51, 32},
                                                    {59, 37},
                                                    {68, 43},
                                                    {79, 50},
                                                    {88, 56},
                                                    {98, 62},
                                                    {108, 68}}}},
                                                 {"j6",
                                                  {{{4, -2},
                                                    {6, -2},
                                                    {7, -2},
                                                    {8, -3},
                                                    {9, -4},
                                                    {11, -5},
                                                    {12, -7},
                                                    {13, -9},
                                                    {14, -11},
                                                    {16, -13},
                                                    {16, -16},
                                                    {18, -18},
                                                    {20, -20}}}},
                                                 {"j7",
                                                  {{{6, -4},
                                                    {8, -4},
                                                    {10, -5},
                                                    {12, -6},
                                                    {13, -8},
                                                    {15, -10},
                                                    {18, -12},
                                                    {20, -15},
                                                    {22, -18},
                                                    {25, -21},
                                                    {26, -26},
                                                    {29, -28},
                                                    {31, -32}}}},
                                                 {"J6",
                                                  {{{2, -4},
                                                    {5, -3},
                                                    {5, -4},
                                                    {6, -5},
                                                    {8, -5},
                                                    {10, -6},
                                                    {13, -6},
                                                    {16, -6},
                                                    {18, -7},
                                                    {22, -7},
                                                    {25, -7},
                                                    {29, -7},
                                                    {33, -7}}}},
                                                 {"J7",
                                                  {{{4, -6},
                                                    {6, -6},
                                                    {8, -7},
                                                    {10, -8},
                                                    {12, -9},
                                                    {14, -11},
                                                    {18, -12},
                                                    {22, -13},
                                                    {26, -14},
                                                    {30, -16},
                                                    {36, -16},
                                                    {39, -18},
                                                    {43, -20}}}},
                                                 {"J8",
                                                  {{{6, -8},
                                                    {10, -8},
                                                    {12, -10},
                                                    {15, -12},
                                                    {20, -13},
                                                    {24, -15},
                                                    {28, -18},
                                                    {34, -20},
                                                    {41, -22},
                                                    {47, -25},
                                                    {55, -26},
                                                    {60, -29},
                                                    {66, -31}}}},
                                                 {"js6",
                                                  {{{3, -3},
                                                    {4, -4},
                                                    {4.5, -4.5},
                                                    {5.5, -5.5},
                                                    {6.5, -6.5},
                                                    {8, -8},
                                                    {9.5, -9.5},
                                                    {11, -11},
                                                    {12.5, -12.5},
                                                    {14.5, -14.5},
                                                    {16, -16},
                                                    {18, -18},
                                                    {20, -20}}}},
                                                 {"K7",
                                                  {{{0, -10},
                                                    {3, -9},
                                                    {5, -10},
                                                    {6, -12},
                                                    {6, -15},
                                                    {7, -18},
                                                    {9, -21},
                                                    {10, -25},
                                                    {12, -28},
                                                    {13, -33},
                                                    {16, -36},
                                                    {17, -40},
                                                    {18, -45}}}},
                                                 {"M7",
                                                  {{{-2, -12},
                                                    {0, -12},
                                                    {0, -15},
                                                    {0, -18},
                                                    {0, -21},
                                                    {0, -25},
                                                    {0, -30},
                                                    {0, -35},
                                                    {0, -40},
                                                    {0, -46},
                                                    {0, -52},
                                                    {0, -57},
                                                    {0, -63}}}},
                                                 {"M6",
                                                  {{{-2, -8},
                                                    {-1, -9},
                                                    {-3, -12},
                                                    {-4, -15},
                                                    {-4, -17},
                                                    {-4, -20},
                                                    {-5, -24},
                                                    {-6, -28},
                                                    {-8, -33},
                                                    {-8, -37},
                                                    {-9, -41},
                                                    {-10, -46},
                                                    {-10, -50}}}},
                                                 {"N7",
                                                  {{{-4, -14},
                                                    {-4, -16},
                                                    {-4, -19},
                                                    {-5, -23},
                                                    {-7, -28},
                                                    {-8, -33},
                                                    {-9, -39},
                                                    {-10, -45},
                                                    {-12, -52},
                                                    {-14, -60},
                                                    {-14, -66},
                                                    {-16, -73},
                                                    {-17, -80}}}},
                                                 {"N9",
                                                  {{{-4, -29},
                                                    {0, -30},
                                                    {0, -36},
                                                    {0, -43},
                                                    {0, -52},
                                                    {0, -62},
                                                    {0, -74},
                                                    {0, -87},
                                                    {0, -100},
                                                    {0, -115},
                                                    {0, -130},
                                                    {0, -140},
                                                    {0, -155}}}},
                                                 {"P7",
                                                  {{{-6, -16},
                                                    {-8, -20},
                                                    {-9, -24},
                                                    {-11, -29},
                                                    {-14, -35},
                                                    {-17, -42},
                                                    {-21, -51},
                                                    {-24, -59},
                                                    {-28, -68},
                                                    {-33, -79},
                                                    {-36, -88},
                                                    {-41, -98},
                                                    {-45, -108}}}},
                                                 {"P9",
                                                  {{{-6, -31},
                                                    {-12, -42},
                                                    {-15, -51},
                                                    {-18, -61},
                                                    {-22, -74},
                                                    {-26, -88},
                                                    {-32, -106},
                                                    {-37, -124},
                                                    {-43, -143},
                                                    {-50, -165},
                                                    {-56, -186},
                                                    {-62, -202},
                                                    {-68, -223}}}},
                                                 {"F8",
                                                  {{{20, 6},
                                                    {28, 10},
                                                    {35, 13},
                                                    {43, 16},
                                                    {53, 20},
                                                    {64, 25},
                                                    {76, 30},
                                                    {90, 36},
                                                    {106, 43},
                                                    {122, 50},
                                                    {137, 56},
                                                    {151, 62},
                                                    {165, 68}}}},
                                                 {"G7",
                                                  {{{12, 2},
                                                    {16, 4},
                                                    {20, 5},
                                                    {24, 6},
                                                    {28, 7},
                                                    {34, 9},
                                                    {40, 10},
                                                    {47, 12},
                                                    {54, 14},
                                                    {61, 15},
                                                    {69, 17},
                                                    {75, 18},
                                                    {83, 20}}}},
                                                 {"D10",
                                                  {{{60, 20},
                                                    {78, 30},
                                                    {98, 40},
                                                    {120, 50},
                                                    {149, 65},
                                                    {180, 80},
                                                    {220, 100},
                                                    {260, 120},
                                                    {305, 145},
                                                    {355, 170},
                                                    {400, 190},
                                                    {440, 210},
                                                    {480, 230}}}},
                                                 {"E9",
                                                  {{{39, 14},
                                                    {50, 20},
                                                    {61, 25},
                                                    {75, 32},
                                                    {92, 40},
                                                    {112, 50},
                                                    {134, 60},
                                                    {159, 72},
                                                    {185, 85},
                                                    {215, 100},
                                                    {240, 110},
                                                    {265, 125},
                                                    {290, 135}}}}};
  return classes;
}

TEST(Iso286, EveryPrintedRowAtBothEndsOfItsStep) {
  for (const PrintedClass& row : printed())
    for (std::size_t step = 0; step < kStepEnds_mm.size(); ++step) {
      const double above = step == 0 ? 1.5 : kStepEnds_mm[step - 1] * (1.0 + 1e-9) + 1e-3;
      for (const double nominal : {above, kStepEnds_mm[step]}) {
        EXPECT_NEAR(upper_um(row.code, nominal), row.upper_lower_um[step][0], 1e-9)
            << row.code << " at " << nominal;
        EXPECT_NEAR(lower_um(row.code, nominal), row.upper_lower_um[step][1], 1e-9)
            << row.code << " at " << nominal;
      }
    }
}

TEST(Iso286, FineStepLettersAsPrinted) {
  struct Row {
    const char* code;
    double nominal_mm, upper, lower;
  };
  constexpr Row kRows[] = {
      {"r6", 3, 16, 10},       {"r6", 20, 41, 28},      {"r6", 50, 50, 34},
      {"r6", 65, 60, 41},      {"r6", 66, 62, 43},      {"r6", 100, 73, 51},
      {"r6", 120, 76, 54},     {"r6", 140, 88, 63},     {"r6", 500, 172, 132},
      {"s6", 3, 20, 14},       {"s6", 20, 48, 35},      {"s6", 50, 59, 43},
      {"s6", 65, 72, 53},      {"s6", 80, 78, 59},      {"s6", 120, 101, 79},
      {"s6", 180, 133, 108},   {"s6", 250, 169, 140},   {"s6", 500, 292, 252},
      {"t6", 30, 54, 41},      {"t6", 40, 64, 48},      {"t6", 80, 94, 75},
      {"u6", 18, 44, 33},      {"u6", 24, 54, 41},      {"u6", 30, 61, 48},
      {"u6", 100, 146, 124},   {"R7", 20, -20, -41},    {"S7", 20, -27, -48},
      {"S7", 50, -34, -59},    {"U7", 30, -40, -61},    {"c11", 20, -110, -240},
      {"c11", 50, -130, -290}, {"C11", 20, 240, 110},   {"a11", 20, -300, -430},
      {"b11", 20, -160, -290}, {"c11", 500, -480, -880}};
  for (const Row& row : kRows) {
    EXPECT_NEAR(upper_um(row.code, row.nominal_mm), row.upper, 1e-9) << row.code << row.nominal_mm;
    EXPECT_NEAR(lower_um(row.code, row.nominal_mm), row.lower, 1e-9) << row.code << row.nominal_mm;
  }
}

TEST(Iso286, WorkedFits) {
  struct Row {
    const char* code;
    double clearance_lo_um, clearance_hi_um;
  };
  constexpr Row kRows[] = {{"H7/g6", 7, 41},  {"H7/h6", 0, 34},   {"H7/k6", -15, 19},
                           {"H7/n6", -28, 6}, {"H7/p6", -35, -1}, {"H8/f7", 20, 74}};
  for (const Row& row : kRows) {
    const auto fit = iso286_fit(row.code, 20.0);
    ASSERT_TRUE(fit) << row.code;
    EXPECT_NEAR(fit->clearance_mm.lo * 1e3, row.clearance_lo_um, 1e-9) << row.code;
    EXPECT_NEAR(fit->clearance_mm.hi * 1e3, row.clearance_hi_um, 1e-9) << row.code;
  }
}

// The standard's tables round its formulas, so they must lie near them: a slip of a digit or a row
// that slid by a step does not.
TEST(Iso286, TablesStayNearTheFormulasTheyRound) {
  constexpr double kGradeFactor[] = {7,   10,  16,  25,  40,   64,   100,
                                     160, 250, 400, 640, 1000, 1600, 2500};
  for (std::size_t step = 2; step < kStepEnds_mm.size(); ++step) {
    const double d = std::sqrt(kStepEnds_mm[step - 1] * kStepEnds_mm[step]);
    const double unit_um = 0.45 * std::cbrt(d) + 0.001 * d;
    for (int grade = 5; grade <= 18; ++grade) {
      const double formula = kGradeFactor[grade - 5] * unit_um;
      const std::string code = class_of("H", grade);
      EXPECT_NEAR(upper_um(code, kStepEnds_mm[step]), formula, 0.05 * formula + 0.6) << code;
    }
    const double end = kStepEnds_mm[step];
    EXPECT_NEAR(upper_um("d9", end), -16.0 * std::pow(d, 0.44), 0.07 * 16.0 * std::pow(d, 0.44));
    EXPECT_NEAR(upper_um("e8", end), -11.0 * std::pow(d, 0.41), 0.06 * 11.0 * std::pow(d, 0.41));
    EXPECT_NEAR(upper_um("f7", end), -5.5 * std::pow(d, 0.41),
                0.06 * 5.5 * std::pow(d, 0.41) + 0.5);
    EXPECT_NEAR(upper_um("g6", end), -2.5 * std::pow(d, 0.34),
                0.07 * 2.5 * std::pow(d, 0.34) + 0.5);
    EXPECT_NEAR(lower_um("n6", end), 5.0 * std::pow(d, 0.34), 0.06 * 5.0 * std::pow(d, 0.34) + 0.5);
  }
}

TEST(Iso286, GradesGrowByTenEveryFiveSteps) {
  for (const double nominal : {20.0, 200.0})
    for (int grade = 6; grade <= 11; ++grade)
      EXPECT_NEAR(upper_um(class_of("H", grade + 5), nominal),
                  10.0 * upper_um(class_of("H", grade), nominal), 1e-9);
}

TEST(Iso286, DeviationOfKHoldsForGradesFourToSevenOnly) {
  EXPECT_NEAR(lower_um("k7", 20.0), 2.0, 1e-9);
  EXPECT_NEAR(lower_um("k8", 20.0), 0.0, 1e-9);
  EXPECT_NEAR(lower_um("k3", 20.0), 0.0, 1e-9);
  EXPECT_NEAR(lower_um("k6", 3.0), 0.0, 1e-9);
  EXPECT_NEAR(upper_um("g6", 8.0), -5.0, 1e-9);  // -8 in one public table is wrong
}

TEST(Iso286, ASizeThatWentThroughInchesKeepsItsStep) {
  const double nominal_mm = 30.0 / 25.4 * 25.4 * (1.0 + 4e-16);
  EXPECT_NEAR(lower_um("r6", nominal_mm), 28.0, 1e-9);
}

void expect_error(const std::string& code, double nominal_mm, const std::string& says) {
  const auto limits = iso286_limits(code, nominal_mm);
  ASSERT_FALSE(limits) << code;
  EXPECT_NE(limits.error().text.find(says), std::string::npos)
      << code << ": " << limits.error().text << " (looked for: " << says << ")";
}

TEST(Iso286, UnknownNamesTheNearestKnown) {
  expect_error("q6", 20, "p and r");
  expect_error("I7", 20, "H and J");
  expect_error("h19", 20, "nearest known: 18");
  expect_error("h0", 20, "nearest known: 1");
  expect_error("K9", 20, "K8");
  expect_error("J9", 20, "JS");
  expect_error("j8", 20, "js");
  expect_error("t6", 20, "s and u");
  expect_error("fg7", 20, "e and f");
  expect_error("7H", 20, "H7");
  expect_error("H", 20, "H7");
  expect_error("", 20, "H7");
  expect_error("h6", 501, "500 mm");
  expect_error("h6", 0, "500 mm");
  expect_error("h6", NAN, "500 mm");
  expect_error("h14", 1.0, "13");
}

TEST(Iso286, AFitNeedsAHoleAndAShaftInThatOrder) {
  for (const char* code : {"g6/H7", "H7/H7", "h6/h6", "H7", "H7-g6", "/", "H7/"}) {
    const auto fit = iso286_fit(code, 20.0);
    EXPECT_FALSE(fit) << code;
  }
}

}  // namespace
}  // namespace mortise
