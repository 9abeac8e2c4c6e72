#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "client/replay/change.h"
#include "common/io/log/session_log_read.h"
#include "common/io/report_json.h"
#include "common/session/tick/statistics.h"

namespace mortise {

/// The clashes of a session as it was, or as it would have been.
struct Clashes {
  std::vector<SessionStatistics::ClashRow> rows;  ///< by begin
  SessionNames names;
  double tick_rate_hz = 60.0;
  std::uint64_t ticks = 0, not_examined = 0;
  std::string stopped_early;  ///< why the log was not computed to its end, or empty
};

/// Computes a log again with changes; none: as it was. Cost: that of the session's engine, less its
/// waiting. The log is copied only where a mesh changes.
Result<Clashes> clashes_with(const SessionLog& log, const std::vector<Change>& changes);

/// Can these changes hold in the session as it begins? Computes nothing of it.
Status check_changes(const SessionLog& log, const std::vector<Change>& changes);

/// How many clashes by worst class, the number of which is the index.
std::array<std::uint64_t, 4> by_class(const Clashes& clashes);

/// One clash in both, or in one of them (the other index is kNone).
struct ClashPair {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::size_t before = kNone, after = kNone;
};
/// Which clash of one is which of the other: the same pair of parts, and the longest time in
/// common; what has none in common is a clash of its own. A clash that fell into several is named
/// with each.
std::vector<ClashPair> matched(const Clashes& before, const Clashes& after);

/// Those of another class, begun or gone; what matters most first.
std::vector<ClashPair> changed_clashes(const Clashes& before, const Clashes& after);

/// What one variant comes to.
struct Variant {
  std::size_t index = 0;             ///< in the whole sweep
  std::vector<std::string> changes;  ///< as written
  Clashes clashes;
  std::string error;  ///< why there is no answer, or empty
};

/// {"changes", "clashes": {by class}, "changed": [...], ...}; see client/replay/README.md.
Json json_of(const Variant& variant, const Clashes& before);
/// For people: counts by class, and each clash whose class changed, was and is.
std::string text_of(const Variant& variant, const Clashes& before);

}  // namespace mortise
