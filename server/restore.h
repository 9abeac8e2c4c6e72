#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/io/log/session_log.h"
#include "common/io/log/session_log_read.h"
#include "common/session/tick/statistics.h"
#include "common/session/world/world.h"

namespace mortise {

/// A session that was restored from its log.
struct Resumed {
  SessionStatistics statistics;
  /// The state after the last tick of the log, for the next log to begin with; none without a tick.
  std::optional<LogBegin> begin;
  /// The departures of all users, who left with the old server: applied to the world, to be logged
  /// with the first tick. Users come back under the same name and are the same users again.
  std::vector<Decision> departures;
  std::uint64_t ticks = 0;           ///< of the log, and part of the session
  std::uint64_t ticks_computed = 0;  ///< of these; earlier ones are covered by a checkpoint
  std::uint64_t ticks_left_out = 0;  ///< behind a gap: they cannot be computed
  std::string left_out_because;      ///< empty: none left out
  std::string missing_at_end;        ///< what the log may not have behind its last tick, in words
};

enum class Newest { kBegun, kWritten };
/// The logs of the session in a folder, the one that was begun, or written to, last first; the last
/// file of its chain when `place` is a file.
std::vector<std::filesystem::path> logs_to_restore(const std::filesystem::path& place,
                                                   const std::string& session,
                                                   Newest by = Newest::kBegun);

/// Plays a log again in `world`, as scene_of(log) made it or as of one of its checkpoints, and
/// compares each tick with its logged events and state hash. Afterwards parts, clashes with their
/// ids, event numbers and the undo history are those after the last tick of the log. Costs the
/// engine's work since the checkpoint. all_depart false: users stay present, for the log of a
/// server that still leads. Fails (kMismatch) where the log and this engine disagree, and
/// (kRuntime) where `stop`, asked after each tick, said so.
Result<Resumed> resume_from(const SessionLog& log, World& world, int threads,
                            bool all_depart = true, const std::function<bool()>& stop = {});

}  // namespace mortise
