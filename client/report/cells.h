#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "client/report/session_tables.h"

namespace mortise {

/// Text as text of a page.
std::string escaped(std::string_view text);

/// A row of a table by the names of its columns.
class Cells {
 public:
  Cells(const Table& table, const std::vector<Json>& row) : table_(table), row_(row) {}

  const Json& operator[](std::string_view name) const;  ///< null when there is no such column
  std::string raw(std::string_view name) const;         ///< "" for null
  std::string text(std::string_view name) const { return escaped(raw(name)); }
  double number(std::string_view name) const;       ///< NaN when it is no number
  std::string length(std::string_view name) const;  ///< of mm, to read; a dash when no number

 private:
  const Table& table_;
  const std::vector<Json>& row_;
};

/// Rows with real clashes first, then with potential, then with fake ones; the more the earlier.
void worst_first(Table& table);

}  // namespace mortise
