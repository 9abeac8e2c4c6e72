#include "client/report/cells.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/base/plain_text.h"
#include "common/messages/length_text.h"

namespace mortise {

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : as_utf8(text)) switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  return safe;
}

const Json& Cells::operator[](std::string_view name) const {
  static const Json kNothing;
  for (std::size_t i = 0; i < row_.size(); ++i)
    if (table_.columns[i].name == name) return row_[i];
  return kNothing;
}

std::string Cells::raw(std::string_view name) const {
  const Json& value = (*this)[name];
  if (value.is_null()) return "";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

double Cells::number(std::string_view name) const {
  const Json& value = (*this)[name];
  return value.is_number() ? value.get<double>() : std::nan("");
}

std::string Cells::length(std::string_view name) const {
  const double mm = number(name);
  return std::isfinite(mm) ? length_text(mm) : "–";
}

void worst_first(Table& table) {
  const auto counts = [&](const std::vector<Json>& row) {
    const Cells cells(table, row);
    return std::tuple(cells.number("real"), cells.number("potential"), cells.number("fake"));
  };
  std::stable_sort(table.rows.begin(), table.rows.end(),
                   [&](const auto& x, const auto& y) { return counts(x) > counts(y); });
}

}  // namespace mortise
