#pragma once
#include <optional>
#include <string>

namespace mortise {

/// "ISO 2768-m", "ISO 2768-mK", "m": the letter of its class of linear sizes. Nothing when unknown.
std::optional<std::string> general_class(const std::string& text);

/// ISO 2768-1:1989, table 1: permissible deviation of a linear size, ± mm. Sizes below 0.5 mm and
/// above 2000 mm, and class f above 2000 mm, have none there: nothing.
std::optional<double> general_deviation_mm(const std::string& letter, double size_mm);

}  // namespace mortise
