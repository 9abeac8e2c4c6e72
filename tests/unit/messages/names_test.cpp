#include <gtest/gtest.h>

#include <set>
#include <string>

#include "common/messages/names.h"

namespace mortise {
namespace {

TEST(Names, EveryRefusalHasItsOwnName) {
  std::set<std::string> names;
  for (std::uint8_t i = 0; i < kRefusalCount; ++i)
    names.insert(std::string(name_of(static_cast<Refusal>(i))));
  EXPECT_EQ(names.size(), kRefusalCount);
  EXPECT_EQ(names.count("?"), 0U);
  EXPECT_EQ(name_of(static_cast<Refusal>(kRefusalCount)),
            "?");  // a new reason must be given a name and a number
}

TEST(Names, ClassesAreThePapers) {
  EXPECT_EQ(name_of(CollisionClass::kReal), "real");
  EXPECT_EQ(name_of(CollisionClass::kPotential), "potential");
  EXPECT_EQ(name_of(CollisionClass::kFake), "fake");
}

}  // namespace
}  // namespace mortise
