#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/nearest_word.h"

namespace mortise {

/// The units that files and command lines may name, in mm.
struct LengthUnit {
  const char* name;
  double mm;
};
inline constexpr std::array<LengthUnit, 5> kLengthUnits{
    {{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}, {"in", 25.4}, {"um", 1e-3}}};

inline std::vector<std::string> length_unit_names() {
  std::vector<std::string> names;
  for (const LengthUnit& unit : kLengthUnits) names.emplace_back(unit.name);
  return names;
}

/// Nothing for an unknown name.
inline std::optional<double> length_unit_mm(std::string_view name) {
  for (const LengthUnit& unit : kLengthUnits)
    if (name == unit.name) return unit.mm;
  return std::nullopt;
}

}  // namespace mortise
