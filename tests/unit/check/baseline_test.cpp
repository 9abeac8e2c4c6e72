#include "client/tools/check/baseline.h"

#include <gtest/gtest.h>

#include "client/tools/check/check.h"
#include "tests/support/test_folder.h"

namespace mortise {
namespace {

Json report_with(const std::string& klass, double depth_mm, const char* part_b) {
  Json pair = {{"class", klass}, {"relation", "unknown"}, {"explained", false}, {"muted", false}};
  pair["instances"] = Json::array({Json::array({"a", part_b})});
  pair["verdicts"] = Json::array({{{"delta_mm", {depth_mm, depth_mm}}}});
  return {{"counts", {{"unexplained_real", 1}, {"potential", 0}, {"near", 0}}},
          {"pairs", Json::array({pair})}};
}

// In a folder of its own: tests run beside each other.
class Baseline : public testing::Test {
 protected:
  std::string written(const Json& report) const {
    return folder_.write("baseline.json", report.dump());
  }

 private:
  test::TestFolder folder_;
};

TEST_F(Baseline, TellsNewGoneChangedAndUnchanged) {
  const std::string file = written(report_with("real", 0.5, "b"));
  Json same = report_with("real", 0.5004, "b");
  ASSERT_TRUE(compare_with_baseline(file, same));
  EXPECT_EQ(same["baseline"]["unchanged"], 1);
  EXPECT_FALSE(fails_on("new", same));
  Json deeper = report_with("real", 0.6, "b");
  ASSERT_TRUE(compare_with_baseline(file, deeper));
  EXPECT_EQ(deeper["baseline"]["changed"].size(), 1U);
  Json other = report_with("potential", 0.1, "c");
  ASSERT_TRUE(compare_with_baseline(file, other));
  EXPECT_EQ(other["baseline"]["new"].size(), 1U);
  EXPECT_EQ(other["baseline"]["gone"].size(), 1U);
  EXPECT_TRUE(fails_on("new", other));
}

TEST_F(Baseline, WhatIsNoReportIsRefused) {
  Json report = report_with("real", 0.5, "b");
  EXPECT_FALSE(compare_with_baseline(written(Json::array()), report));
  EXPECT_FALSE(compare_with_baseline("/nowhere.json", report));
}

TEST(CheckReport, WhatNothingExplainsIsReadFirst) {
  CheckReport report;
  const auto add = [&](CollisionClass c, bool explained, bool contact, double depth_mm) {
    CheckedPair pair;
    const auto id = static_cast<std::uint32_t>(report.pairs.size());
    pair.a = PartId{2 * id + 1};
    pair.b = PartId{2 * id + 2};
    pair.all = {{pair.a, pair.b}};
    pair.collision_class = c;
    pair.explained = explained;
    pair.is_contact = contact;
    Verdict v;
    v.delta_mm = {depth_mm, depth_mm};
    pair.verdicts = {v};
    report.pairs.push_back(pair);
  };
  add(CollisionClass::kFake, false, true, 0.1);
  add(CollisionClass::kReal, true, false, 9.0);
  add(CollisionClass::kReal, false, false, 0.2);
  add(CollisionClass::kPotential, false, false, 5.0);
  add(CollisionClass::kReal, false, false, 0.3);
  report.pairs.back().all.emplace_back(PartId{21}, PartId{22});
  order_and_count(report);
  EXPECT_EQ(report.pairs[0].verdicts[0].delta_mm.lo, 0.3);
  EXPECT_EQ(report.pairs[1].verdicts[0].delta_mm.lo, 0.2);
  EXPECT_EQ(report.pairs[2].collision_class, CollisionClass::kPotential);
  EXPECT_TRUE(report.pairs[3].explained);
  EXPECT_EQ(report.counts.unexplained_real, 3U);  // instances, not rows
  EXPECT_EQ(report.counts.explained_real, 1U);
  EXPECT_EQ(report.counts.contacts, 1U);
}

}  // namespace
}  // namespace mortise
