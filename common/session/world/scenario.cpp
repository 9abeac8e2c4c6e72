#include "common/session/world/scenario.h"

#include "common/base/plain_text.h"

namespace mortise {
std::string_view name_of(Right value) {
  switch (value) {
    case Right::kUnknown:
      return "unknown";
    case Right::kPolicy:
      return "policy";
    case Right::kTolerance:
      return "tolerance";
    case Right::kExclusions:
      return "exclusions";
    case Right::kReview:
      return "review";
    case Right::kParts:
      return "parts";
  }
  return "?";
}

std::optional<Right> right_named(std::string_view name) {
  for (const Right right :
       {Right::kPolicy, Right::kTolerance, Right::kExclusions, Right::kReview, Right::kParts})
    if (name_of(right) == name) return right;
  return std::nullopt;
}

bool is_part_name(std::string_view name) {
  return is_name(name) && name.find_first_of(".*") == std::string_view::npos;
}

}  // namespace mortise
