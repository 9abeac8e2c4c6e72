#pragma once
#include <functional>
#include <map>

#include "common/io/log/log_json.h"
#include "common/io/log/session_log.h"
#include "common/io/scenario/scenario_file.h"

namespace mortise {

/// Ticks without a record between two records of a log, when nothing was sent: a day at 1000 a
/// second. A longer pause is a damaged number, which must not keep anybody busy for ever.
inline constexpr std::uint64_t kMostIdleTicks = 86'400'000;
/// The same between two records of these times: they are computed again, and what a number alone
/// claims is not worth it. A server writes a record each ten minutes, whatever its clock says.
std::uint64_t most_idle_ticks(double rate_hz, std::int64_t from_ns, std::int64_t to_ns);

/// Ticks that happened and are missing in the log.
struct LogGap {
  std::uint64_t after_tick = 0;  ///< last tick before it (0: none)
  std::uint64_t until_tick = 0;  ///< first tick after it (0: none)
  std::string reason;
  bool was_recorded = false;  ///< the file held them when it was closed
};

/// A log that was read. It is readable without its tail; `complete` says whether the end was found.
/// Poses of ticks are rounded, for viewing; a replay computes the exact ones.
struct SessionLog {
  std::string session, scenario_name, scenario_yaml, engine_version, build_fingerprint;
  std::vector<std::pair<std::string, TriangleMesh>> meshes;
  std::vector<std::string> mesh_of_part;
  std::vector<ImportReport> imports;  ///< by part index; may be empty
  std::vector<std::byte> assembly;    ///< what the importer said of a STEP file; may be empty
  std::vector<TickRecord> ticks;      ///< report holds tick, events, moved, refused and state_hash
  std::optional<LogBegin> begin;      ///< set: the file continues another one
  LogChain chain;
  std::string last_seal;  ///< digest of the last one that is whole; empty: none
  /// By tick; with those at the front of later files, but without that of `begin`.
  std::vector<Checkpoint> checkpoints;
  bool complete = false;
  std::vector<LogGap> gaps;  ///< in the order of the log
  /// Sums of /statistics by name: what was examined and skipped, without lost parts of the log.
  std::map<std::string, std::uint64_t> counted;
  std::vector<log_json::TickTimes> times;  ///< in their order; empty: not measured
  std::vector<std::string> notes;          ///< what was lost or skipped, in words
};

/// Server clock of the last tick of a log, or of the tick that it begins with; 0: it has neither.
std::int64_t last_time_ns(const SessionLog& log);

/// What a file once held behind its last tick, in words; empty: nothing.
std::string cut_off_of(const SessionLog& log);

struct LogReading {
  /// Keep the bytes of so many last checkpoints; of all others only the hash.
  std::size_t keep_checkpoints = 0;
  /// Called with the number of files read so far, the current one in part.
  std::function<void(double files)> on_progress = {};
};
/// The scenario as it was played, with the parts of its assembly.
Result<ScenarioReading> scenario_of(const SessionLog& log);

Result<SessionLog> read_session_log(const std::filesystem::path& file,
                                    const LogReading& reading = {});

}  // namespace mortise
