#include "common/evaluation/iso286.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "tests/unit/evaluation/iso286_steps.h"

// Limits as the standard's second part prints them, class by class: written down apart from the
// library's tables, which have the form of the first part. Rules that hold between table rows, and
// the formulas that they round, are in iso286_rules_test.cpp.
namespace mortise {
namespace {

struct PrintedClass {
  const char* code;
  const char* upper_lower_um;  // upper/lower in each of the 13 main steps
};
constexpr PrintedClass kPrinted[] = {
    {"H7", "10/0 12/0 15/0 18/0 21/0 25/0 30/0 35/0 40/0 46/0 52/0 57/0 63/0"},
    {"H6", "6/0 8/0 9/0 11/0 13/0 16/0 19/0 22/0 25/0 29/0 32/0 36/0 40/0"},
    {"H11", "60/0 75/0 90/0 110/0 130/0 160/0 190/0 220/0 250/0 290/0 320/0 360/0 400/0"},
    {"h9", "0/-25 0/-30 0/-36 0/-43 0/-52 0/-62 0/-74 0/-87 0/-100 0/-115 0/-130 0/-140 0/-155"},
    {"g6",
     "-2/-8 -4/-12 -5/-14 -6/-17 -7/-20 -9/-25 -10/-29 -12/-34 -14/-39 -15/-44 -17/-49 -18/-54 "
     "-20/-60"},
    {"f7",
     "-6/-16 -10/-22 -13/-28 -16/-34 -20/-41 -25/-50 -30/-60 -36/-71 -43/-83 -50/-96 -56/-108 "
     "-62/-119 -68/-131"},
    {"e8",
     "-14/-28 -20/-38 -25/-47 -32/-59 -40/-73 -50/-89 -60/-106 -72/-126 -85/-148 -100/-172 "
     "-110/-191 -125/-214 -135/-232"},
    {"d9",
     "-20/-45 -30/-60 -40/-76 -50/-93 -65/-117 -80/-142 -100/-174 -120/-207 -145/-245 -170/-285 "
     "-190/-320 -210/-350 -230/-385"},
    {"k6", "6/0 9/1 10/1 12/1 15/2 18/2 21/2 25/3 28/3 33/4 36/4 40/4 45/5"},
    {"m6", "8/2 12/4 15/6 18/7 21/8 25/9 30/11 35/13 40/15 46/17 52/20 57/21 63/23"},
    {"n6", "10/4 16/8 19/10 23/12 28/15 33/17 39/20 45/23 52/27 60/31 66/34 73/37 80/40"},
    {"p6", "12/6 20/12 24/15 29/18 35/22 42/26 51/32 59/37 68/43 79/50 88/56 98/62 108/68"},
    {"j6", "4/-2 6/-2 7/-2 8/-3 9/-4 11/-5 12/-7 13/-9 14/-11 16/-13 16/-16 18/-18 20/-20"},
    {"j7", "6/-4 8/-4 10/-5 12/-6 13/-8 15/-10 18/-12 20/-15 22/-18 25/-21 26/-26 29/-28 31/-32"},
    {"J6", "2/-4 5/-3 5/-4 6/-5 8/-5 10/-6 13/-6 16/-6 18/-7 22/-7 25/-7 29/-7 33/-7"},
    {"J7", "4/-6 6/-6 8/-7 10/-8 12/-9 14/-11 18/-12 22/-13 26/-14 30/-16 36/-16 39/-18 43/-20"},
    {"J8",
     "6/-8 10/-8 12/-10 15/-12 20/-13 24/-15 28/-18 34/-20 41/-22 47/-25 55/-26 60/-29 66/-31"},
    {"js6",
     "3/-3 4/-4 4.5/-4.5 5.5/-5.5 6.5/-6.5 8/-8 9.5/-9.5 11/-11 12.5/-12.5 14.5/-14.5 16/-16 "
     "18/-18 20/-20"},
    {"K7", "0/-10 3/-9 5/-10 6/-12 6/-15 7/-18 9/-21 10/-25 12/-28 13/-33 16/-36 17/-40 18/-45"},
    {"M7", "-2/-12 0/-12 0/-15 0/-18 0/-21 0/-25 0/-30 0/-35 0/-40 0/-46 0/-52 0/-57 0/-63"},
    {"M6",
     "-2/-8 -1/-9 -3/-12 -4/-15 -4/-17 -4/-20 -5/-24 -6/-28 -8/-33 -8/-37 -9/-41 -10/-46 -10/-50"},
    {"N7",
     "-4/-14 -4/-16 -4/-19 -5/-23 -7/-28 -8/-33 -9/-39 -10/-45 -12/-52 -14/-60 -14/-66 -16/-73 "
     "-17/-80"},
    {"N9", "-4/-29 0/-30 0/-36 0/-43 0/-52 0/-62 0/-74 0/-87 0/-100 0/-115 0/-130 0/-140 0/-155"},
    {"P7",
     "-6/-16 -8/-20 -9/-24 -11/-29 -14/-35 -17/-42 -21/-51 -24/-59 -28/-68 -33/-79 -36/-88 -41/-98 "
     "-45/-108"},
    {"P9",
     "-6/-31 -12/-42 -15/-51 -18/-61 -22/-74 -26/-88 -32/-106 -37/-124 -43/-143 -50/-165 -56/-186 "
     "-62/-202 -68/-223"},
    {"F8", "20/6 28/10 35/13 43/16 53/20 64/25 76/30 90/36 106/43 122/50 137/56 151/62 165/68"},
    {"G7", "12/2 16/4 20/5 24/6 28/7 34/9 40/10 47/12 54/14 61/15 69/17 75/18 83/20"},
    {"D10",
     "60/20 78/30 98/40 120/50 149/65 180/80 220/100 260/120 305/145 355/170 400/190 440/210 "
     "480/230"},
    {"E9",
     "39/14 50/20 61/25 75/32 92/40 112/50 134/60 159/72 185/85 215/100 240/110 265/125 290/135"},
};

TEST(Iso286, EveryPrintedRowAtBothEndsOfItsStep) {
  for (const PrintedClass& row : kPrinted) {
    std::istringstream text(row.upper_lower_um);
    for (std::size_t step = 0; step < kMainEnds_mm.size(); ++step) {
      double upper = NAN, lower = NAN;
      char slash = 0;
      ASSERT_TRUE(text >> upper >> slash >> lower) << row.code;
      for (const double nominal : {just_above(lower_end(kMainEnds_mm, step)), kMainEnds_mm[step]}) {
        EXPECT_NEAR(upper_um(row.code, nominal), upper, 1e-9) << row.code << " at " << nominal;
        EXPECT_NEAR(lower_um(row.code, nominal), lower, 1e-9) << row.code << " at " << nominal;
      }
    }
  }
}

TEST(Iso286, WorkedLimits) {
  struct Row {
    double nominal_mm;
    const char* code;
    double upper, lower;
  };
  constexpr Row kRows[] = {// shafts of the intermediate steps
                           {3, "r6", 16, 10},
                           {20, "r6", 41, 28},
                           {50, "r6", 50, 34},
                           {65, "r6", 60, 41},
                           {66, "r6", 62, 43},
                           {100, "r6", 73, 51},
                           {120, "r6", 76, 54},
                           {140, "r6", 88, 63},
                           {500, "r6", 172, 132},
                           {3, "s6", 20, 14},
                           {20, "s6", 48, 35},
                           {50, "s6", 59, 43},
                           {65, "s6", 72, 53},
                           {80, "s6", 78, 59},
                           {100, "s6", 93, 71},
                           {120, "s6", 101, 79},
                           {180, "s6", 133, 108},
                           {250, "s6", 169, 140},
                           {500, "s6", 292, 252},
                           {30, "t6", 54, 41},
                           {40, "t6", 64, 48},
                           {80, "t6", 94, 75},
                           {18, "u6", 44, 33},
                           {24, "u6", 54, 41},
                           {30, "u6", 61, 48},
                           {100, "u6", 146, 124},
                           {20, "c11", -110, -240},
                           {50, "c11", -130, -290},
                           {500, "c11", -480, -880},
                           {20, "a11", -300, -430},
                           {20, "b11", -160, -290},
                           {132.5, "a13", -460, -1090},
                           // letters of tight and of very loose fits
                           {2, "cd7", -34, -44},
                           {8, "cd6", -56, -65},
                           {8, "ef6", -18, -27},
                           {8, "fg6", -8, -17},
                           {45, "cd7", -100, -125},
                           {45, "ef7", -35, -60},
                           {45, "fg6", -15, -31},
                           {16, "v6", 50, 39},
                           {30, "v7", 76, 55},
                           {30, "x6", 77, 64},
                           {12, "x8", 67, 40},
                           {24, "y7", 84, 63},
                           {30, "z7", 109, 88},
                           {16, "z8", 87, 60},
                           {100, "za7", 370, 335},
                           {100, "zb8", 499, 445},
                           {50, "zc8", 364, 325},
                           {500, "zc11", 3000, 2600},
                           // holes with and without Delta
                           {25, "P7", -14, -35},
                           {20, "P6", -18, -31},
                           {20, "P8", -22, -55},
                           {20, "R6", -24, -37},
                           {20, "R7", -20, -41},
                           {20, "S7", -27, -48},
                           {50, "S7", -34, -59},
                           {30, "U6", -44, -57},
                           {30, "U7", -40, -61},
                           {30, "X7", -56, -77},
                           {50, "ZC8", -325, -364},
                           {20, "C11", 240, 110},
                           {8, "CD8", 78, 56},
                           {20, "K4", 0, -6},
                           {20, "K5", 1, -8},
                           {20, "K6", 2, -11},
                           {20, "K8", 10, -23},
                           {20, "M5", -5, -14},
                           {20, "M8", 4, -29},
                           {20, "N6", -11, -24},
                           {20, "N8", -3, -36},
                           {2, "M7", -2, -12},
                           {2, "N9", -4, -29},
                           {2, "K9", 0, -25},
                           {2, "P7", -6, -16},
                           {20, "M9", -8, -60},
                           // k beside its grades, j8 where it exists, the finest grades
                           {20, "k7", 23, 2},
                           {20, "k8", 33, 0},
                           {20, "k3", 4, 0},
                           {3, "k6", 6, 0},
                           {2, "j8", 8, -6},
                           {20, "h01", 0, -0.6},
                           {20, "H0", 1, 0},
                           {20, "h1", 0, -1.5},
                           {150, "H01", 1.2, 0},
                           {8, "g6", -5, -14}};
  for (const Row& row : kRows) {
    EXPECT_NEAR(upper_um(row.code, row.nominal_mm), row.upper, 1e-9) << row.nominal_mm << row.code;
    EXPECT_NEAR(lower_um(row.code, row.nominal_mm), row.lower, 1e-9) << row.nominal_mm << row.code;
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

TEST(Iso286, ASizeThatWentThroughInchesKeepsItsStep) {
  const double nominal_mm = 30.0 / 25.4 * 25.4 * (1.0 + 4e-16);
  EXPECT_NEAR(lower_um("r6", nominal_mm), 28.0, 1e-9);
}

void expect_error(const std::string& code, double nominal_mm, const std::string& says) {
  const auto limits = iso286_limits(code, nominal_mm);
  ASSERT_FALSE(limits) << code << " " << nominal_mm;
  EXPECT_NE(limits.error().text.find(says), std::string::npos)
      << code << ": " << limits.error().text << " (looked for: " << says << ")";
}

TEST(Iso286, UnknownNamesTheNearestKnown) {
  expect_error("q6", 20, "p and r");
  expect_error("I7", 20, "H and J");
  expect_error("h19", 20, "nearest known: 18");
  expect_error("h02", 20, "H7");
  expect_error("h001", 20, "H7");
  expect_error("ab6", 20, "a and b");
  expect_error("zd6", 20, "zc");
  expect_error("Js6", 20, "JS or js");
  expect_error("7H", 20, "H7");
  expect_error("H", 20, "H7");
  expect_error("", 20, "H7");
  expect_error("h6", 501, "500 mm");
  expect_error("h6", 0, "500 mm");
  expect_error("h6", NAN, "500 mm");
}

TEST(Iso286, WhereTheStandardHasNoValueItSaysSo) {
  expect_error("K9", 20, "K8");
  expect_error("J9", 20, "JS");
  expect_error("j8", 20, "js");
  expect_error("j4", 2, "js");
  expect_error("t6", 20, "no t up to 24 mm; nearest known: s and u");
  expect_error("T7", 24, "no T up to 24 mm");
  expect_error("v6", 14, "no v up to 14 mm; nearest known: u and x");
  expect_error("y6", 18, "no y up to 18 mm; nearest known: x and z");
  expect_error("cd7", 51, "no cd above 50 mm; nearest known: c and d");
  expect_error("EF8", 400, "no EF above 50 mm");
  expect_error("fg7", 60, "nearest known: f and g");
  expect_error("P2", 20, "from grade 3");
  expect_error("h14", 1.0, "13");
  expect_error("N9", 1.0, "N8");
  expect_error("a11", 1.0, "c");
  expect_error("B11", 0.8, "C");
}

TEST(Iso286, AFitNeedsAHoleAndAShaftInThatOrder) {
  for (const char* code : {"g6/H7", "H7/H7", "h6/h6", "H7", "H7-g6", "/", "H7/"}) {
    const auto fit = iso286_fit(code, 20.0);
    EXPECT_FALSE(fit) << code;
  }
}

}  // namespace
}  // namespace mortise
