#include "common/base/shared_vector.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

TEST(SharedVector, ACopyThatChangesLeavesTheOtherAsItWas) {
  const SharedVector<int> first{0, 1, 2};
  SharedVector<int> second = first;
  EXPECT_EQ(first.data(), second.data()) << "shared";
  second.change()[1] = 7;
  EXPECT_EQ(first.values(), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(second.values(), (std::vector<int>{0, 7, 2}));
  const int* own = second.data();
  second.change()[2] = 8;
  EXPECT_EQ(own, second.data()) << "its own are not copied again";
}

TEST(SharedVector, HoldsNothingUntilItIsChanged) {
  SharedVector<int> none;
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.begin(), none.end());
  EXPECT_EQ(none, SharedVector<int>(std::vector<int>{}));
  none.change().push_back(3);
  EXPECT_EQ(none.size(), 1u);
  EXPECT_EQ(none.front(), none.back());
  EXPECT_FALSE(none == SharedVector<int>{});
}

}  // namespace
}  // namespace mortise
