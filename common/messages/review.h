#pragma once
#include <cstdint>
#include <string>

#include "common/base/ids.h"

namespace mortise {

/// The review status that people give to a clash; it is independent of the class. A clash that gets
/// worse loses its approval and is active again.
enum class ReviewStatus : std::uint8_t {
  kNew = 0,       ///< not looked at yet
  kActive = 1,    ///< in work
  kReviewed = 2,  ///< looked at, not decided
  kApproved = 3,  ///< may stay as it is
  kResolved = 4,  ///< solved, though it may still be open
};
inline constexpr std::uint8_t kReviewStatusCount = 5;

struct Review {
  ReviewStatus status = ReviewStatus::kNew;
  std::string comment;
  UserId user;             ///< who set it; none: never set, by the scenario, or an approval lapsed
  std::uint64_t tick = 0;  ///< when, 0: never
};

/// What somebody said of a clash with one review: the remarks of a clash are its thread.
struct Remark {
  ClashId clash;
  UserId user;
  UserId assignee;  ///< whose task it is from then on; none: nobody's
  ReviewStatus status = ReviewStatus::kNew;
  std::uint64_t tick = 0;
  std::string text;  ///< may be empty
  friend bool operator==(const Remark&, const Remark&) = default;
};

}  // namespace mortise
