#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace mortise::lint {

struct BareConstant {
  std::string name;
  std::size_t line = 0;  ///< counted from one
};

/// Numbers that are declared as `constexpr ... kName` without a comment that says why they are what
/// they are: behind one, directly above it, or above the constants that it stands among without an
/// empty line. Not asked for: 0, 1 and 2 without a unit, all bits set, counts of an enumeration
/// (kThingCount), conversions (kUmPerMm), and what is made of other names alone.
std::vector<BareConstant> constants_without_reason(const std::string& source);

}  // namespace mortise::lint
