#include "common/geometry/face_of_triangle.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

TEST(FaceOfTriangle, ACopyThatChangesLeavesTheOtherAsItWas) {
  const FaceOfTriangle first{0, 1, 2};
  FaceOfTriangle second = first;
  EXPECT_EQ(&*first.begin(), &*second.begin()) << "shared";
  second.set(1, 7);
  EXPECT_EQ(first[1], 1);
  EXPECT_EQ(second[1], 7);
  EXPECT_NE(&*first.begin(), &*second.begin());
  const auto* own = &*second.begin();
  second.set(2, 8);
  EXPECT_EQ(own, &*second.begin()) << "its own are not copied again";
}

TEST(FaceOfTriangle, AreOrderedByWhatTheyHold) {
  const FaceOfTriangle none, first{0, 1, 2}, alike(std::vector<std::uint16_t>{0, 1, 2});
  EXPECT_EQ(first, alike);
  EXPECT_NE(first, none);
  EXPECT_LT(none, first);
  EXPECT_LT(first, FaceOfTriangle({0, 2}));
  EXPECT_GT(first, FaceOfTriangle({0, 1}));
}

}  // namespace
}  // namespace mortise
