#include "common/io/report_json.h"

#include <gtest/gtest.h>

#include <limits>

namespace mortise {
namespace {

SessionNames names() { return {{"shaft", "housing"}, {"anna"}}; }

StepReport report_with_a_clash() {
  StepReport report;
  report.tick = 7;
  ClashEvent event;
  event.kind = ClashEvent::Kind::kBegin;
  event.seq = 1;
  event.tick = event.begin_tick = 7;
  event.clash = ClashId{1};
  event.part_a = PartId{1};
  event.part_b = PartId{2};
  event.user = UserId{1};
  event.verdict.collision_class = event.worst_class = CollisionClass::kPotential;
  event.verdict.delta_mm = {0.05, 0.0501};
  event.verdict.gpd_mm = {0.05, std::numeric_limits<double>::infinity()};
  event.verdict.fake_below_mm = 0.02;
  event.verdict.real_above_mm = 0.08;
  event.verdict.explanation = "overlap 50.0 µm: potential";
  report.events.push_back(event);
  report.counters.pairs = {10, 2};
  report.counters.pairs_still = 8;
  report.counters.increments = {3, 1};
  report.counters.refused[static_cast<std::size_t>(Refusal::kNotHolder)] = 2;
  return report;
}

TEST(SessionNames, UnknownIdsAreNamedByNumber) {
  EXPECT_EQ(names().part(PartId{2}), "housing");
  EXPECT_EQ(names().part(PartId{}), "none");
  EXPECT_EQ(names().user(UserId{9}), "#9");
  EXPECT_EQ(names().pair(PartId{1}, PartId{2}), "shaft × housing");
}

TEST(ReportJson, InfinityIsNullAndTheTextParsesBack) {
  Verdict verdict;
  verdict.gpd_mm = {0.1, std::numeric_limits<double>::infinity()};
  verdict.margin_mm = std::numeric_limits<double>::quiet_NaN();
  const Json json = Json::parse(json_of(verdict).dump());
  EXPECT_TRUE(json["gpd_mm"][1].is_null());
  EXPECT_EQ(json["gpd_mm"][0], 0.1);
  EXPECT_TRUE(json["margin_mm"].is_null());
  EXPECT_TRUE(json["witness_mm"].is_null());
  EXPECT_EQ(json["probability"], 0.0);
  verdict.probability = kProbabilityUnknown;
  EXPECT_TRUE(json_of(verdict)["probability"].is_null());
}

TEST(ReportJson, StatisticsSayWhoWithWhomAndWhatWasSkipped) {
  SessionStatistics statistics;
  statistics.add(report_with_a_clash());
  const Json json = json_of(statistics, names());
  EXPECT_EQ(json["by_class"]["potential"]["total"], 1);
  EXPECT_EQ(json["by_class"]["potential"]["open"], 1);
  EXPECT_EQ(json["by_class"]["real"]["total"], 0);
  ASSERT_EQ(json["by_pair"].size(), 1U);
  EXPECT_EQ(json["by_pair"][0]["part_a"], "shaft");
  EXPECT_EQ(json["by_pair"][0]["worst"]["real_above_mm"], 0.08);
  ASSERT_EQ(json["by_user"].size(), 1U);
  EXPECT_EQ(json["by_user"][0]["user"], "anna");
  EXPECT_EQ(json["stages"]["pairs"]["skipped"]["still"], 8);
  EXPECT_EQ(json["stages"]["increments"]["refused"]["not the holder"], 2);
  EXPECT_EQ(json["clashes"][0]["open"], true);
}

TEST(ReportTables, NameThePairBothThresholdsTheSentenceAndTheReasons) {
  SessionStatistics statistics;
  statistics.add(report_with_a_clash());
  const std::string table = collision_table(statistics, names());
  for (const char* part : {"pairs of parts", "anna", "POTENTIAL  shaft × housing   P(interference)",
                           "tick 7", "overlap 50.0 µm: potential"}) {
    EXPECT_NE(table.find(part), std::string::npos) << part << " is missing in\n" << table;
  }
  const std::string stages = stage_table(statistics.counters());
  EXPECT_NE(stages.find("8 both still"), std::string::npos) << stages;
  EXPECT_NE(stages.find("2 not the holder"), std::string::npos) << stages;
  EXPECT_EQ(stages.find("NOT examined"), std::string::npos);
  StepCounters capped;
  capped.not_examined = 1;
  EXPECT_NE(stage_table(capped).find("NOT examined"), std::string::npos);
}

}  // namespace
}  // namespace mortise
