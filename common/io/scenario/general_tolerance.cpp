#include "common/io/scenario/general_tolerance.h"

#include <array>

namespace mortise {
namespace {

// ISO 2768-1:1989, table 1.
struct Row {
  double up_to_mm;
  std::array<double, 4> deviation_mm;  // f, m, c, v; 0: none
};
constexpr std::array<Row, 7> kRows = {{{3.0, {0.05, 0.1, 0.2, 0.0}},
                                       {6.0, {0.05, 0.1, 0.3, 0.5}},
                                       {30.0, {0.1, 0.2, 0.5, 1.0}},
                                       {120.0, {0.15, 0.3, 0.8, 1.5}},
                                       {400.0, {0.2, 0.5, 1.2, 2.5}},
                                       {1000.0, {0.3, 0.8, 2.0, 4.0}},
                                       {2000.0, {0.5, 1.2, 3.0, 6.0}}}};
constexpr std::string_view kLetters = "fmcv";

}  // namespace

std::optional<std::string> general_class(const std::string& text) {
  std::string rest = text;
  for (const char* prefix : {"ISO 2768-1-", "ISO 2768-", "ISO2768-"})
    if (rest.starts_with(prefix)) {
      rest.erase(0, std::string_view(prefix).size());
      break;
    }
  // "mK": the second letter is of form and place.
  if (rest.empty() || rest.size() > 2 || kLetters.find(rest[0]) == std::string_view::npos)
    return std::nullopt;
  return rest.substr(0, 1);
}

std::optional<double> general_deviation_mm(const std::string& letter, double size_mm) {
  const std::size_t column = letter.empty() ? std::string_view::npos : kLetters.find(letter[0]);
  if (column == std::string_view::npos || !(size_mm >= 0.5)) return std::nullopt;
  for (const Row& row : kRows)
    if (size_mm <= row.up_to_mm) {
      const double deviation = row.deviation_mm[column];
      return deviation > 0.0 ? std::optional(deviation) : std::nullopt;
    }
  return std::nullopt;
}

}  // namespace mortise
