// What the text of a STEP file forbids, or says is missing, before the library has read it.
#include "common/io/step/step_objections.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

// A place of product `child` in product `parent`.
std::string place(int label, int parent, int child) {
  return "#" + std::to_string(label) + "=NEXT_ASSEMBLY_USAGE_OCCURRENCE('a','','',#" +
         std::to_string(parent) + ",#" + std::to_string(child) + ",$);\n";
}

// Assemblies 1, 2, ... each with so many places of the next one.
std::string nested(int levels, int places) {
  std::string text;
  int label = 10'000;
  for (int i = 1; i < levels; ++i)
    for (int k = 0; k < places; ++k) text += place(label++, i, i + 1);
  return text;
}

std::string refusal_of(const std::string& text) { return step_refusal(StepText(text)); }

TEST(StepObjections, ATreeThatIsTooLargeIsRefusedByItsCount) {
  EXPECT_EQ(refusal_of(nested(17, 2)), "");  // 65,536 instances
  EXPECT_EQ(refusal_of(nested(18, 2)),
            "it has more than 100000 instances; export a part of the assembly");
  EXPECT_EQ(refusal_of(nested(200, 9)),
            "it has more than 100000 instances; export a part of the assembly");
}

TEST(StepObjections, DeepIsNotCalledCyclic) {
  EXPECT_EQ(refusal_of(nested(200, 1)), "");
  EXPECT_EQ(refusal_of(nested(201, 1)),
            "its assemblies are nested deeper than 200 levels; export it with fewer");
  EXPECT_EQ(refusal_of(nested(50'000, 1)),
            "its assemblies are nested deeper than 200 levels; export it with fewer");
  EXPECT_EQ(refusal_of(place(7, 1, 2) + place(8, 2, 3) + place(9, 3, 1)),
            "line 1: #7: its assemblies contain each other; export it again");
  EXPECT_EQ(refusal_of(place(7, 1, 1)),
            "line 1: #7: its assemblies contain each other; export it again");
}

// An operator (#5) with these axes and scale, and what names it.
std::string placed_by(const std::string& axes_and_scale, const std::string& named_by) {
  return "#1=CARTESIAN_POINT('',(0.,0.,0.));\n#2=DIRECTION('',(-1.,0.,0.));\n"
         "#3=DIRECTION('',(0.,1.,0.));\n#4=DIRECTION('',(0.,0.,1.));\n"
         "#5=" +
         axes_and_scale + ";\n" + named_by;
}

constexpr const char* kRelation =
    "#6=(REPRESENTATION_RELATIONSHIP('','',#8,#9)REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION("
    "#5)SHAPE_REPRESENTATION_RELATIONSHIP());\n";
constexpr const char* kMapped =
    "#6=MAPPED_ITEM('',#7,#5);\n#7=REPRESENTATION_MAP(#1,#8);\n"
    "#8=ADVANCED_BREP_SHAPE_REPRESENTATION('',(#1),#9);\n";
constexpr const char* kSign =
    "#6=MAPPED_ITEM('',#7,#5);\n#7=REPRESENTATION_MAP(#1,#8);\n"
    "#8=SYMBOL_REPRESENTATION('',(#1),#9);\n";

TEST(StepObjections, AMirroredOrScaledPartIsRefused) {
  const std::string of = "CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',''";
  const std::string mirror = of + ",#2,#3,#1,1.,#4)", scale = of + ",$,$,#1,2.,$)";
  for (const char* by : {kRelation, kMapped}) {
    EXPECT_EQ(refusal_of(placed_by(mirror, by)),
              "line 5: #5 mirrors a part (CARTESIAN_TRANSFORMATION_OPERATOR_3D), which is not "
              "read; export such a part as one of its own");
    EXPECT_NE(refusal_of(placed_by(scale, by)).find("#5 scales a part"), std::string::npos);
    EXPECT_NE(refusal_of(placed_by(of + ",#4,#3,#1,0.,#2)", by)).find("scales"), std::string::npos);
    EXPECT_NE(refusal_of(placed_by("(CARTESIAN_TRANSFORMATION_OPERATOR(#2,#3,#1,$)"
                                   "CARTESIAN_TRANSFORMATION_OPERATOR_3D(#4))",
                                   by))
                  .find("#5 mirrors"),
              std::string::npos);
    // Motions alone.
    EXPECT_EQ(refusal_of(placed_by(of + ",#4,#3,#1,1.,#2)", by)), "");
    EXPECT_EQ(refusal_of(placed_by(of + ",$,$,#1,$,$)", by)), "");
  }
  // Of a sign of an annotation, or of nothing.
  EXPECT_EQ(refusal_of(placed_by(scale, kSign)), "");
  EXPECT_EQ(refusal_of(placed_by(mirror, "")), "");
}

TEST(StepObjections, APlaceThatMirrorsIsLeftOutAlone) {
  const std::string mirror =
      placed_by("CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',#2,#3,#1,1.,#4)", kRelation);
  const std::string usage = place(12, 13, 14) + "#11=PRODUCT_DEFINITION_SHAPE('','',#12);\n" +
                            "#10=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#6,#11);\n";
  EXPECT_EQ(refusal_of(mirror + usage), "");
  const auto left_out = step_left_out(StepText(mirror + usage));
  ASSERT_EQ(left_out.size(), 1U);
  EXPECT_EQ(left_out.begin()->first, 12);
  EXPECT_NE(left_out.begin()->second.find("line 5: #5 mirrors a part"), std::string::npos);
  // Of a place, and of something else.
  const std::string item = "#16=MAPPED_ITEM('',#17,#5);\n";
  EXPECT_NE(refusal_of(mirror + usage + item).find("#5 mirrors a part"), std::string::npos);
}

TEST(StepObjections, APointHasThreeNumbers) {
  EXPECT_TRUE(step_crowded_points(StepText("#1=CARTESIAN_POINT('a,b,c,d',(0.,0.,1.));\n"
                                           "#2=DIRECTION('',(0.,1.));\n"))
                  .empty());
  const auto said = step_crowded_points(StepText("#1=CARTESIAN_POINT('',(0.,0.,1.,0.));\n"));
  ASSERT_EQ(said.size(), 1U);
  EXPECT_NE(said[0].find("line 1: #1 CARTESIAN_POINT has more than three numbers"),
            std::string::npos);
}

TEST(StepObjections, WhatIsNamedAndNotThereIsMissing) {
  const StepText whole("#1=A('#7 is a text',#2);\n#2=B(/* #8 */ #1);\n");
  EXPECT_TRUE(step_missing(whole).empty());
  const StepText text("#1=A('',#2);\n\n#2=B((#1,#31),#32);\n");
  ASSERT_EQ(step_missing(text).size(), 1U);
  EXPECT_EQ(step_missing(text)[0],
            "line 3: #2 names #31, which is not in the file (the first of 2 such references); what "
            "hangs on it is missing or in a wrong place; export it again");
}

}  // namespace
}  // namespace mortise
