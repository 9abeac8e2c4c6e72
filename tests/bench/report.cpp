#include "tests/bench/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/base/check.h"

namespace mortise::bench {
namespace {

std::string four_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string text_of(const Cell& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  if (const auto* count = std::get_if<long long>(&cell)) return std::to_string(*count);
  const double value = std::get<double>(cell);
  return std::isnan(value) ? "-" : four_digits(value);
}

nlohmann::ordered_json json_of(const Cell& cell) {
  return std::visit([](const auto& value) { return nlohmann::ordered_json(value); }, cell);
}

void print_head(const std::vector<std::string>& columns) {
  std::string head = "|", rule = "|";
  for (const std::string& column : columns) {
    head.append(" ").append(column).append(" |");
    rule += "---|";
  }
  std::printf("%s\n%s\n", head.c_str(), rule.c_str());
}

}  // namespace

bool Bar::holds() const {
  return std::isfinite(figure) && (kind == BoundKind::kAtLeast ? figure >= bound : figure <= bound);
}

void Report::table(const std::string& title, const std::vector<std::string>& columns) {
  columns_ = columns;
  tables_.push_back({{"title", title}, {"rows", nlohmann::ordered_json::array()}});
  std::printf("\n### %s\n\n", title.c_str());
  print_head(columns);
  std::fflush(stdout);
}

void Report::row(const std::vector<Cell>& cells) {
  MORTISE_CHECK(!tables_.empty() && cells.size() == columns_.size(),
                "a row has one cell for each column of its table");
  nlohmann::ordered_json object;
  std::string line = "|";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    object[columns_[i]] = json_of(cells[i]);
    line.append(" ").append(text_of(cells[i])).append(" |");
  }
  tables_.back()["rows"].push_back(std::move(object));
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

void Report::note(const std::string& text) {
  notes_.push_back(text);
  std::printf("\n%s\n", text.c_str());
  std::fflush(stdout);
}

void Report::bar(const std::string& name, double figure, double bound, BoundKind kind) {
  bars_.push_back({name, figure, bound, kind});
}

bool Report::all_bars_hold() const {
  return std::all_of(bars_.begin(), bars_.end(), [](const Bar& bar) { return bar.holds(); });
}

void Report::print_bars() const {
  std::printf("\n### Bars\n\n");
  print_head({"bar", "figure", "bound", "holds"});
  for (const Bar& bar : bars_)
    std::printf("| %s | %s | %s %s | %s |\n", bar.name.c_str(), text_of(bar.figure).c_str(),
                bar.kind == BoundKind::kAtLeast ? ">=" : "<=", four_digits(bar.bound).c_str(),
                bar.holds() ? "yes" : "NO");
  std::fflush(stdout);
}

nlohmann::ordered_json Report::json() const {
  nlohmann::ordered_json document = {{"tables", tables_}, {"notes", notes_}};
  document["bars"] = nlohmann::ordered_json::array();
  for (const Bar& bar : bars_)
    document["bars"].push_back({{"name", bar.name},
                                {"figure", bar.figure},
                                {"kind", bar.kind == BoundKind::kAtLeast ? "at least" : "at most"},
                                {"bound", bar.bound},
                                {"holds", bar.holds()}});
  return document;
}

}  // namespace mortise::bench
