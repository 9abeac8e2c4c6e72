#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/io/log/session_log.h"
#include "common/session/tick/statistics.h"
#include "common/session/world/world.h"

namespace mortise {

/// How a session goes on that its log told again.
struct Resumed {
  SessionStatistics statistics;
  /// The state after the last tick that was told, for the next log to begin with; none when nothing
  /// was told.
  std::optional<LogBegin> begin;
  /// Everybody who was there is gone with the old server: applied to the world, to be logged with
  /// the first tick. They come back by name and are the same users again.
  std::vector<Decision> departures;
  std::uint64_t ticks = 0;           ///< told by the log, and part of the session
  std::uint64_t ticks_computed = 0;  ///< of these; those before stand in a checkpoint
  std::uint64_t ticks_left_out = 0;  ///< behind a gap: they cannot be computed
  std::string left_out_because;      ///< empty: none was
};

enum class Newest { kBegun, kWritten };
/// The log of the session in a folder that was begun, or written to, last; the last of its chain
/// when `place` is no folder; none when the folder holds no log of it.
std::optional<std::filesystem::path> log_to_restore(const std::filesystem::path& place,
                                                    const std::string& session,
                                                    Newest by = Newest::kBegun);

/// Plays a log again in `world`, which stands as scene_of(log) made it or as at one of its
/// checkpoints; each tick is held against its logged events and state hash. Afterwards parts,
/// clashes with their ids, numbers of events and what can be undone are what they were after the
/// last tick of the log. Costs what the session cost the engine since the checkpoint. Not
/// all_depart: who was there stays, for a server that still leads. Fails (kMismatch) where the log
/// and this engine disagree.
Result<Resumed> resume_from(const SessionLog& log, World& world, int threads,
                            bool all_depart = true);

}  // namespace mortise
