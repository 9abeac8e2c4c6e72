#pragma once
#include <cstddef>
#include <string>
#include <string_view>

#include "common/base/result.h"

namespace YAML {
class Node;
}

namespace mortise {

/// A scenario or a play is written by people: 16 MiB is a hundred thousand parts with room to
/// spare.
inline constexpr std::size_t kMostYaml_bytes = 16U << 20;

/// Parses text into one document, with the keys that `<<: *other` takes over. Refused: what is not
/// UTF-8, more than one document, too deep, too large, or aliases that expand to more values than
/// the largest scenario has.
Result<YAML::Node> parse_yaml(std::string_view yaml, const std::string& name);

}  // namespace mortise
