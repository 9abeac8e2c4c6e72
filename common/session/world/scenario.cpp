#include "common/session/world/scenario.h"

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
  }
  return "?";
}

std::optional<Right> right_named(std::string_view name) {
  for (const Right right : {Right::kPolicy, Right::kTolerance, Right::kExclusions, Right::kReview})
    if (name_of(right) == name) return right;
  return std::nullopt;
}

}  // namespace mortise
