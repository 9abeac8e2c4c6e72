#pragma once
#include <cstdint>
#include <string>

#include "common/base/ids.h"

namespace mortise {

/// What people have made of a clash; its class is physics and stands apart. A clash that gets worse
/// loses its approval: it is active again.
enum class ReviewStatus : std::uint8_t {
  kNew = 0,       ///< nobody has looked at it
  kActive = 1,    ///< somebody works on it
  kReviewed = 2,  ///< looked at, not decided
  kApproved = 3,  ///< may stay as it is
  kResolved = 4,  ///< taken care of, though it may still be seen
};
inline constexpr std::uint8_t kReviewStatusCount = 5;

struct Review {
  ReviewStatus status = ReviewStatus::kNew;
  std::string comment;
  UserId user;             ///< who said so; none: nobody, or the session took an approval back
  std::uint64_t tick = 0;  ///< when, 0: never
};

}  // namespace mortise
