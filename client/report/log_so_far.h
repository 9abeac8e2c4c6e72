#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "common/base/result.h"
#include "common/io/log/session_log_read.h"

namespace mortise {

/// A log that may still be written, for questions about its moments: it is read again only for a
/// moment behind what was read of it.
class LogSoFar {
 public:
  using Read = std::function<Result<SessionLog>()>;
  using Answer = std::function<Result<std::string>(const SessionLog&)>;
  explicit LogSoFar(Read read) : read_(std::move(read)) {}

  /// Answers from the log up to a tick at least, or from all of it.
  Result<std::string> answer(std::uint64_t until_tick, const Answer& make);

 private:
  Read read_;
  std::optional<SessionLog> log_;  ///< none: not read yet, or too large to be kept
};

}  // namespace mortise
