// The plots of the page tell what the tables tell.
#include "client/report/plots.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

using Type = Table::Type;

Table named(const char* name, std::vector<const char*> texts, std::vector<const char*> numbers) {
  Table table{name, "", {}, {}};
  for (const char* text : texts) table.columns.push_back({text, Type::kText});
  for (const char* number : numbers) table.columns.push_back({number, Type::kNumber});
  return table;
}

SessionReport two_clashes() {
  SessionReport report;
  report.session = "plots";
  Table session = named("session", {"key", "value"}, {});
  session.rows = {{"tick_rate_hz", "60"}, {"end_s", "10"}};
  Table clashes = named("clashes", {"class", "part_a", "part_b", "face_a", "face_b", "explanation"},
                        {"clash", "begin_s", "duration_s", "overlap_lo_mm", "fake_below_mm",
                         "real_above_mm", "margin_mm", "severity", "probability"});
  clashes.rows = {
      {"potential", "a<b", "c", "", "", "", 1, 1.0, 4.0, 0.02, 0.01, 0.05, 0.0, 0.2, 0.3},
      {"real", "a<b", "d", "", "", "", 2, 2.0, 8.0, 0.4, 0.01, 0.05, 0.3, 2.0, nullptr}};
  Table events = named(
      "events", {"kind", "class"},
      {"clash", "overlap_lo_mm", "overlap_hi_mm", "fake_below_mm", "real_above_mm", "time_s"});
  events.rows = {{"begin", "fake", 1, 0.005, 0.006, 0.01, 0.05, 1.0},
                 {"begin", "real", 2, 0.4, nullptr, 0.01, 0.05, 2.0},
                 {"change", "potential", 1, 0.02, 0.03, 0.01, 0.05, 3.0},
                 {"review", "potential", 1, 0.02, 0.03, 0.01, 0.05, 4.0},
                 {"end", "none", 1, 0.0, 0.0, 0.01, 0.05, 5.0}};
  Table times = named("tick_times", {}, {"ticks", "begin_s", "end_s", "mean_us", "max_us"});
  for (int s = 0; s < 10; ++s)
    times.rows.push_back({60, s, s + 1.0, 200.0, s == 4 ? 30000.0 : 900.0});
  report.tables = {session, clashes, events, times};
  return report;
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

TEST(Plots, EachClashHasARowTheWorstFirstAndPiecesByClass) {
  const std::string html = depth_section(two_clashes());
  const std::size_t real = html.find("R #2 a&lt;b"), potential = html.find("P #1 a&lt;b");
  ASSERT_NE(real, std::string::npos) << html;
  ASSERT_NE(potential, std::string::npos);
  EXPECT_LT(real, potential);
  // From 2 s to the end; from 1 to 3 s and from 3 to 5 s of 780 pixels for 10 s.
  EXPECT_NE(html.find("<g class=\"real\"><rect x=\"456.0\""), std::string::npos) << html;
  EXPECT_NE(html.find("width=\"624.0\""), std::string::npos);
  EXPECT_NE(html.find("<g class=\"fake\"><rect x=\"378.0\""), std::string::npos);
  EXPECT_NE(html.find("<g class=\"potential\"><rect x=\"534.0\""), std::string::npos);
  EXPECT_EQ(count(html, "<rect"), 3U) << "a review is no change of depth";
  EXPECT_EQ(count(html, "stroke-dasharray=\"5 3\""), 2U);
  EXPECT_NE(html.find("role=\"img\""), std::string::npos);
  EXPECT_EQ(html.find("nan"), std::string::npos);
}

TEST(Plots, TickTimesStandAgainstTheTimeOfATick) {
  const std::string html = tick_time_section(two_clashes());
  EXPECT_EQ(count(html, "<rect"), 10U);
  EXPECT_NE(html.find("16.67 ms from tick to tick"), std::string::npos) << html;
  EXPECT_NE(html.find(">100 ms</text>"), std::string::npos) << "the longest tick is in the plot";
  EXPECT_EQ(html.find("nan"), std::string::npos);
  SessionReport none = two_clashes();
  table_named(none.tables, "tick_times").rows.clear();
  EXPECT_EQ(tick_time_section(none), "");
}

// An hour is as wide as a minute.
TEST(Plots, LongSessionsAreDrawnInColumns) {
  SessionReport report = two_clashes();
  Table& times = table_named(report.tables, "tick_times");
  times.rows.clear();
  for (int s = 0; s < 3600; ++s)
    times.rows.push_back({60, s, s + 1.0, 200.0, s == 1234 ? 5000.0 : 900.0});
  table_named(report.tables, "session").rows[1] = {"end_s", "3600"};
  EXPECT_LE(count(tick_time_section(report), "<rect"), 390U);
}

}  // namespace
}  // namespace mortise
