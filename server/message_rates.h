#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "server/intake.h"

namespace mortise {

/// Limits the messages a second of each user and of all users together: token buckets of one
/// second.
class MessageRates {
 public:
  explicit MessageRates(const InboxLimits& limits) : limits_(limits) {}

  /// A user has joined: its bucket is full.
  void begin(UserId user, std::int64_t now_ns);
  /// Counts one message of a user who has joined; false: it exceeds a limit.
  bool take(UserId user, std::int64_t now_ns);
  bool has_room(UserId user, std::int64_t now_ns);  ///< would take() be true?

 private:
  struct Bucket {
    double tokens = 0.0;
    std::int64_t at_ns = 0;
  };
  const InboxLimits& limits_;
  std::vector<Bucket> of_user_;   ///< by user index
  std::optional<Bucket> of_all_;  ///< absent before the first message
};

}  // namespace mortise
