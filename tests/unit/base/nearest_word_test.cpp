#include "common/base/nearest_word.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

TEST(NearestWord, IsTheOneThatWasMeant) {
  struct Case {
    const char *typed, *meant;
    std::vector<std::string> known;
  };
  const std::vector<std::string> keys{"name", "units", "policy", "parts", "fits", "users"};
  const std::vector<std::string> pose{"position", "rotation_deg", "quaternion", "axis_angle"};
  for (const Case& c :
       {Case{"polcy", "policy", keys}, Case{"unit", "units", keys},
        Case{"prats", "parts", keys},            // two letters changed places
        Case{"Units", "units", keys},            // capitals
        Case{"rotation", "rotation_deg", pose},  // a beginning, farther in edits
        Case{"inch", "in", {"mm", "cm", "m", "in", "um"}},
        Case{"µm", "um", {"mm", "cm", "m", "in", "um"}},  // the sign of micro
        Case{"μm", "um", {"mm", "cm", "m", "in", "um"}},  // the Greek letter
        Case{"movable", "moving", {"name", "mesh", "moving"}},
        Case{"--pictur", "--picture", {"--json", "--picture", "--region"}},
        Case{"a", "", keys},  // of no word more than of another
        Case{"furlong", "", {"mm", "cm", "m", "in", "um"}},
        Case{"\"", "", {"mm", "cm", "m", "in", "um"}}, Case{"", "", keys}, Case{"x", "", {}}})
    EXPECT_EQ(nearest_word(c.typed, c.known), c.meant) << c.typed;
}

TEST(NearestWord, WhereNoneIsNearTheKnownOnesAreListed) {
  EXPECT_EQ(did_you_mean("polcy", {"name", "policy"}), "; did you mean 'policy'?");
  EXPECT_EQ(did_you_mean("furlong", {"mm", "in"}), "; known: mm, in");
  std::vector<std::string> many;
  for (int i = 10; i < 40; ++i) many.push_back("pin_" + std::to_string(i));
  const std::string text = did_you_mean("lid", many);
  EXPECT_NE(text.find("pin_10, pin_11"), std::string::npos) << text;
  EXPECT_NE(text.find("and 18 more"), std::string::npos) << text;
}

}  // namespace
}  // namespace mortise
