// The gap of two parts of a log, as they stand after a tick.
#include "client/report/gap_answer.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/unit/replay/played.h"

namespace mortise {
namespace {

constexpr PartId kWall{1}, kTool{2};

TEST(GapAnswer, IsOfThePartsAsTheyStandThen) {
  const auto log = played("thin_wall");
  ASSERT_TRUE(log) << log.error().text;
  const auto at = [&](std::uint64_t tick) {
    const auto told = gap_answer(*log, {kTool, kWall, tick});
    EXPECT_TRUE(told) << told.error().text;
    return nlohmann::json::parse(told ? *told : "{}");
  };
  const auto before = at(0), after = at(~std::uint64_t{0});
  EXPECT_EQ(before["a"], kTool.value);
  EXPECT_EQ(before["tick"], 0);
  EXPECT_EQ(after["tick"], log->ticks.back().tick);
  EXPECT_LT(after["mesh_mm"].get<double>(), before["mesh_mm"].get<double>());
  for (const auto& told : {before, after}) {
    EXPECT_LE(told["real_mm"][0].get<double>(), told["mesh_mm"].get<double>());
    EXPECT_GE(told["real_mm"][1].get<double>(), told["mesh_mm"].get<double>());
  }
}

TEST(GapAnswer, IsNoneOfAPartThatIsNotThere) {
  const auto log = played("thin_wall");
  ASSERT_TRUE(log) << log.error().text;
  for (const PartId id : {PartId{}, PartId{9}}) {
    const auto told = gap_answer(*log, {kWall, id, 0});
    ASSERT_FALSE(told);
    EXPECT_EQ(told.error().code, Code::kNotFound);
    EXPECT_EQ(told.error().text, "the session has no part " + std::to_string(id.value) + " then");
  }
}

}  // namespace
}  // namespace mortise
