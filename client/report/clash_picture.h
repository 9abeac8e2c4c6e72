#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "common/base/ids.h"
#include "common/base/result.h"
#include "common/io/log/session_log_read.h"

namespace mortise {

/// Which picture of a log: the clash as it was judged last, up to a tick.
struct ClashMoment {
  ClashId clash;
  std::uint64_t until_tick = std::numeric_limits<std::uint64_t>::max();
};

/// The section of `judge --picture` through one clash of a log, as SVG. kNotFound: the log does not
/// judge this clash up to that tick. Costs loading the scene and one pass.
Result<std::string> clash_picture(const SessionLog& log, const ClashMoment& wanted);

/// Pictures of one log, which may still be written: it is read again only for a moment behind what
/// was read of it.
class ClashPictures {
 public:
  using Read = std::function<Result<SessionLog>()>;
  explicit ClashPictures(Read read) : read_(std::move(read)) {}

  Result<std::string> draw(const ClashMoment& wanted);

 private:
  Read read_;
  std::optional<SessionLog> log_;  ///< none: not read yet, or too large to be kept
};

}  // namespace mortise
