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

template <class Enum>
void expect_all_named(std::uint8_t count) {
  std::set<std::string> names;
  for (std::uint8_t i = 0; i < count; ++i) names.insert(std::string(name_of(static_cast<Enum>(i))));
  EXPECT_EQ(names.size(), count);
  EXPECT_EQ(names.count("?"), 0U);
  EXPECT_EQ(name_of(static_cast<Enum>(count)), "?");
}

TEST(Names, EveryNumberOfTheWireHasItsOwnName) {
  expect_all_named<CommandKind>(kCommandKindCount);
  expect_all_named<Decision::Kind>(kDecisionKindCount);
  expect_all_named<Unexamined>(kUnexaminedCount);
  expect_all_named<ReviewStatus>(kReviewStatusCount);
  expect_all_named<ConstraintKind>(kConstraintKindCount);
  expect_all_named<Role>(kRoleCount);
}

TEST(Names, RolesAreFoundByName) {
  EXPECT_EQ(role_named("observer"), Role::kObserver);
  EXPECT_FALSE(role_named("unknown"));
  EXPECT_FALSE(role_named("emperor"));
}

TEST(Names, ClassesAreThePapers) {
  EXPECT_EQ(name_of(CollisionClass::kReal), "real");
  EXPECT_EQ(name_of(CollisionClass::kPotential), "potential");
  EXPECT_EQ(name_of(CollisionClass::kFake), "fake");
}

}  // namespace
}  // namespace mortise
