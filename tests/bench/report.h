#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

namespace mortise::bench {

/// Text, a measured number (printed with four digits, whole in the JSON), or a count.
using Cell = std::variant<std::string, double, long long>;

/// A figure that is promised. holds: figure >= bound or figure <= bound, after its kind; never for
/// a figure that is not a number.
enum class BoundKind { kAtLeast, kAtMost };
struct Bar {
  std::string name;
  double figure = 0.0, bound = 0.0;
  BoundKind kind = BoundKind::kAtLeast;
  bool holds() const;
};

/// What a benchmark found: printed as Markdown while it runs, kept as JSON to the end.
class Report {
 public:
  /// Prints the head of a table. Rows that follow belong to it.
  void table(const std::string& title, const std::vector<std::string>& columns);
  /// One cell a column of the last table.
  void row(const std::vector<Cell>& cells);
  /// A line of text between tables; kept as a note in the JSON.
  void note(const std::string& text);
  /// A figure to hold. Units belong into the name.
  void bar(const std::string& name, double figure, double bound, BoundKind kind);

  const std::vector<Bar>& bars() const { return bars_; }
  bool all_bars_hold() const;
  /// The bars as the last table.
  void print_bars() const;
  /// {"tables": [{"title", "rows": [{column: value}]}], "notes", "bars": [{"name", "figure",
  /// "kind" ("at least", "at most"), "bound", "holds"}]}. A figure that is not a number is null.
  nlohmann::ordered_json json() const;

 private:
  nlohmann::ordered_json tables_ = nlohmann::ordered_json::array();
  nlohmann::ordered_json notes_ = nlohmann::ordered_json::array();
  std::vector<std::string> columns_;
  std::vector<Bar> bars_;
};

}  // namespace mortise::bench
