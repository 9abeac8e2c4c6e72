#include "tests/bench/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "tests/bench/figures.h"
#include "tests/bench/plot_labels.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Bar, HoldsOnItsOwnSideAndAtTheBound) {
  EXPECT_TRUE((Bar{"", 75.0, 75.0, BoundKind::kAtLeast}).holds());
  EXPECT_FALSE((Bar{"", 74.999, 75.0, BoundKind::kAtLeast}).holds());
  EXPECT_TRUE((Bar{"", 200.0, 200.0, BoundKind::kAtMost}).holds());
  EXPECT_FALSE((Bar{"", 200.001, 200.0, BoundKind::kAtMost}).holds());
}

TEST(Bar, AFigureThatWasNotMeasuredDoesNotHold) {
  EXPECT_FALSE((Bar{"", kNaN, 0.0, BoundKind::kAtLeast}).holds());
  EXPECT_FALSE((Bar{"", kNaN, 0.0, BoundKind::kAtMost}).holds());
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE((Bar{"", infinity, 0.0, BoundKind::kAtLeast}).holds());
}

TEST(Report, OneBarThatDoesNotHoldIsEnough) {
  Report report;
  EXPECT_TRUE(report.all_bars_hold());
  report.bar("fast", 2.0, 1.0, BoundKind::kAtLeast);
  EXPECT_TRUE(report.all_bars_hold());
  report.bar("late", 1.0, 0.0, BoundKind::kAtMost);
  EXPECT_FALSE(report.all_bars_hold());
}

TEST(Report, JsonHoldsTheCellsAndEndsWithTheBars) {
  Report report;
  report.table("times", {"method", "asked", "ms"});
  report.row({std::string("ours"), 3LL, 0.123456789});
  report.row({std::string("peer"), 0LL, kNaN});
  report.bar("times as fast", 80.0, 75.0, BoundKind::kAtLeast);
  const auto document = report.json();
  const auto& rows = document["tables"][0]["rows"];
  EXPECT_EQ(document["tables"][0]["title"], "times");
  EXPECT_EQ(rows[0]["method"], "ours");
  EXPECT_EQ(rows[0]["asked"], 3);
  EXPECT_EQ(rows[0]["ms"], 0.123456789);
  EXPECT_NE(document.dump().find("\"ms\":null"), std::string::npos);
  EXPECT_EQ(document.back(), document["bars"]);
  EXPECT_EQ(
      document["bars"][0].dump(),
      R"({"name":"times as fast","figure":80.0,"kind":"at least","bound":75.0,"holds":true})");
}

std::string text_of_file(const std::string& path) {
  std::ifstream in(std::string(MORTISE_SOURCE_DIR) + "/" + path);
  return {std::istreambuf_iterator<char>(in), {}};
}

const char* const kMake = "make it again: ./mortise bench --figures";

TEST(Figures, ThePageIsWhatTheKeptRunsSay) {
  const auto runs = runs_in(MORTISE_SOURCE_DIR "/tests/bench/figures");
  EXPECT_EQ(text_of_file("tests/bench/FIGURES.md"), figures_page(runs)) << kMake;
}

TEST(Figures, TheTableOfTheReadmeIsWhatTheKeptRunsSay) {
  const std::string readme = text_of_file("README.md");
  const std::string made = with_figures(readme, runs_in(MORTISE_SOURCE_DIR "/tests/bench/figures"));
  EXPECT_EQ(readme, made) << kMake;
  EXPECT_NE(made.find("<!-- figures -->\n| question |"), std::string::npos);
}

TEST(Figures, WideTablesAndSentencesAreCutAndLongNotesAreWrapped) {
  Report report;
  std::vector<std::string> columns;
  std::vector<Cell> cells;
  for (int i = 0; i < 30; ++i) {
    columns.push_back("column " + std::to_string(i));
    cells.push_back(static_cast<long long>(i));
  }
  report.table("wide", columns);
  report.row(cells);
  std::string words;
  for (int i = 0; i < 60; ++i) words += "word ";
  report.table("long", {"what", "sentence"});
  report.row({std::string("a verdict"), words});
  report.note(words);
  report.bar("fast", 0.5, 1.0, BoundKind::kAtMost);
  const KeptRun run = kept_run("example", "./mortise bench example", report.json());
  EXPECT_EQ(KeptRun::parse(text_of(run)), run);
  std::istringstream page(figures_page({run}));
  std::size_t lines = 0, with_first_column = 0, last_column = 0;
  for (std::string line; std::getline(page, line); ++lines) {
    EXPECT_LE(line.size(), 160u) << line;
    with_first_column += line.starts_with("| column 0 |");
    last_column += line.find("| column 29 |") != std::string::npos;
  }
  EXPECT_EQ(with_first_column, 3u);
  EXPECT_EQ(last_column, 1u);
}

TEST(Statistics, QuantilesAreValuesThatWereMeasured) {
  const std::vector<double> values = {5, 1, 4, 2, 3};
  EXPECT_EQ(median(values), 3);
  EXPECT_EQ(quantile(values, 0.2), 1);
  EXPECT_EQ(quantile(values, 0.99), 5);
  EXPECT_EQ(largest(values), 5);
  EXPECT_TRUE(std::isnan(median({})));
}

TEST(Statistics, GeometricMean) {
  EXPECT_NEAR(geometric_mean({1, 100}), 10.0, 1e-12);
  EXPECT_TRUE(std::isnan(geometric_mean({})));
}

TEST(Statistics, TheLeastTimeIsOfOneCall) {
  // Busy for a known number of microseconds of CPU time, however many calls one
  // measurement takes.
  constexpr double kBusy_s = 20e-6;
  const double time_s = least_time_s([&] {
    for (const Stopwatch watch; watch.elapsed_s() < kBusy_s;) {
    }
  });
  EXPECT_GE(time_s, kBusy_s);
}

TEST(LabelPlaces, NoTextCoversAMarkOrAnotherText) {
  LabelPlaces places(800, 500);
  const std::string text = "twenty letters long.";
  std::vector<PixelBox> boxes;
  for (const double y : {250.0, 255.0, 260.0}) places.take({393, y - 7, 407, y + 7});
  for (const double y : {250.0, 255.0, 260.0}) {
    const Placed at = places.place(400, y, text);
    const double length = 6.1 * static_cast<double>(text.size());
    const double x0 = at.to_the_left ? at.x - length : at.x;
    boxes.push_back({x0, at.y - 7, x0 + length, at.y + 7});
  }
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(boxes[i].meets(boxes[k])) << i << " " << k;
}

TEST(LabelPlaces, TextStaysInThePicture) {
  LabelPlaces places(800, 500);
  const Placed at = places.place(795, 250, "a long name of a method");
  EXPECT_TRUE(at.to_the_left);
}

}  // namespace
}  // namespace mortise::bench
