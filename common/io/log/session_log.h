#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/solid.h"
#include "common/io/log/log_seal.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/state/checkpoint.h"
#include "common/messages/increment.h"
#include "common/messages/report.h"
#include "common/session/tick/statistics.h"

namespace mortise {

struct LoadedScene;

/// The whole state of the session after a tick, as it is stored in a log.
struct Checkpoint {
  std::uint64_t tick = 0, state_hash = 0;
  std::string build;             ///< fingerprint of the build that wrote it
  std::string hash;              ///< content hash of the bytes
  std::vector<std::byte> bytes;  ///< see checkpoint.h; empty where a reader did not keep them
  StepCounters counters;         ///< of all ticks of the session up to it that were recorded
};

/// The beginning of a log that continues another one.
struct LogBegin {
  Checkpoint state;
  SessionStatistics statistics;  ///< of all ticks before
  std::int64_t time_ns = 0;      ///< of the last of them; no tick of this log is earlier
};

/// The place of a file among those of one session.
struct LogChain {
  std::string previous;    ///< name of the previous file, in the same folder; empty: the first file
  std::uint64_t part = 1;  ///< 1, 2, 3 ...
  /// The last seal of the previous file that this one goes on from; empty: it had none.
  std::string previous_seal = {};
};

/// What a log starts with: enough to play the session again without any other file.
struct LogHeader {
  std::string session;
  std::string scenario_name;                                        ///< file name, for messages
  std::string scenario_yaml;                                        ///< the text as it was played
  std::vector<std::pair<std::string, const TriangleMesh*>> meshes;  ///< distinct meshes by hash
  std::vector<std::string> mesh_of_part;                            ///< hash, by part index
  std::vector<ImportReport> imports = {};  ///< by part index; empty when not known
  /// What the importer said of the assembly of the scenario; null: it has none.
  std::shared_ptr<const std::vector<std::byte>> assembly = {};
  std::optional<LogBegin> begin = {};  ///< none: the session begins as its scene was loaded
  LogChain chain = {};
};

/// The header of a session that begins with the scene as loaded. It refers to the meshes of the
/// scene, which must outlive it.
LogHeader log_header(const LoadedScene& scene, std::string session, std::string scenario_name,
                     std::string scenario_yaml);

/// One tick as it is recorded: what went in and what came out. Decisions were applied before the
/// increments.
struct TickRecord {
  std::uint64_t tick = 0;
  std::int64_t time_ns = 0;      ///< server clock, for the reader's timeline only
  std::int64_t step_ns = 0;      ///< what the engine took for it; 0: not measured
  std::vector<SolidPtr> meshes;  ///< that its decisions are the first to name
  std::vector<Decision> decisions;
  std::vector<Increment> increments;
  StepReport report;
  StateDraft state = {};  ///< the state after the tick, serialized by the writer; mostly empty
};

struct LogOptions {
  bool compress = true;            ///< chunks; off: readers without zstd can open the log
  std::size_t queue_ticks = 4096;  ///< more than a minute of a stuck disk at 60 ticks a second
  std::size_t chunk_bytes = 1 << 20;
  /// Longest time between two flushes to disk: with what a flush itself takes, a crash costs no
  /// more than the last second.
  double flush_s = 0.9;
  /// Beyond this size the next file is begun with the next checkpoint; 0: all in one.
  std::uint64_t rotate_bytes = 0;
  /// The file and those that follow it are called "x.mcap.begun" until take_name(), and are removed
  /// when closed before. For a standby, whose log must not be mistaken for the session's.
  bool named_later = false;
  std::shared_ptr<const LogSigner> signer = {};  ///< null: nobody signs the log
};

/// The file that follows `file` when it has become too large: "x.mcap", "x_p0002.mcap" ...
std::filesystem::path next_in_chain(const std::filesystem::path& file);

/// Writes an MCAP file in a thread of its own. All calls come from one thread. record() only queues
/// (bounded) and never waits for the disk or the writer. Ticks that a full queue drops are counted
/// in dropped_ticks() and marked in the log as a gap. Chunks are flushed each second. Ticks must
/// rise; ticks without input may be left out, because a replay steps through them. Layout:
/// session_log_format.md. A file gets its name once its head is on disk. The meshes of the header
/// must live as long as the writer, which writes them again at the end.
class SessionLogWriter {
 public:
  static Result<std::unique_ptr<SessionLogWriter>> create(const std::filesystem::path& file,
                                                          const LogHeader& header,
                                                          const LogOptions& options = {});
  virtual ~SessionLogWriter() = default;  ///< closes
  virtual void record(TickRecord record) = 0;
  /// An empty record with the memory of a written one, so that filling it allocates nothing. Only
  /// for the recording thread.
  virtual TickRecord spare() { return {}; }
  /// Does the next file wait for a record with a state?
  virtual bool wants_state() const { return false; }
  /// See LogOptions::named_later.
  virtual Status take_name() { return ok(); }
  /// Waits until all that was recorded so far is on disk.
  virtual Status flush() { return status(); }
  virtual Status close() = 0;  ///< waits until all is on disk; writes index and summary
  virtual std::uint64_t dropped_ticks() const = 0;
  virtual std::uint64_t bytes_written() const = 0;
  virtual std::size_t queued_ticks() const { return 0; }  ///< recorded, but not yet written
  /// Every recorded tick up to here is on disk, or is lost. Never waits.
  virtual std::uint64_t flushed_tick() const { return 0; }
  virtual Status status() const = 0;  ///< fails after an error of the disk: later ticks are dropped
};

}  // namespace mortise
