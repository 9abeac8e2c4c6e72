#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/mesh.h"
#include "common/messages/increment.h"
#include "common/messages/report.h"

namespace mortise {

/// What a log starts with: enough to play the session again without any other file.
struct LogHeader {
  std::string session;
  std::string scenario_name;                                        ///< file name, for messages
  std::string scenario_yaml;                                        ///< the text as it was played
  std::vector<std::pair<std::string, const TriangleMesh*>> meshes;  ///< distinct meshes by hash
  std::vector<std::string> mesh_of_part;                            ///< hash, by part index
};

/// One tick as it is recorded: what went in and what came out. Decisions were applied before the
/// increments.
struct TickRecord {
  std::uint64_t tick = 0;
  std::int64_t time_ns = 0;  ///< server clock, for the reader's timeline only
  std::vector<Decision> decisions;
  std::vector<Increment> increments;
  StepReport report;
};

/// Writes an MCAP file off the caller's thread. record() only queues (bounded); a full queue drops
/// nothing silently: the dropped ticks are counted, said in dropped_ticks(), and marked in the log
/// as a gap. Chunks are flushed each second.
class SessionLogWriter {
 public:
  static Result<std::unique_ptr<SessionLogWriter>> create(const std::filesystem::path& file,
                                                          const LogHeader& header);
  virtual ~SessionLogWriter() = default;  ///< closes
  virtual void record(TickRecord record) = 0;
  virtual Status close() = 0;  ///< waits until all is on disk; writes index and summary
  virtual std::uint64_t dropped_ticks() const = 0;
  virtual std::uint64_t bytes_written() const = 0;
};

/// A log read back. Readable without its tail: `complete` says whether the end was found.
struct SessionLog {
  std::string session, scenario_name, scenario_yaml, engine_version, build_fingerprint;
  std::vector<std::pair<std::string, TriangleMesh>> meshes;
  std::vector<std::string> mesh_of_part;
  std::vector<TickRecord> ticks;  ///< report holds tick, events, moved, refused and state_hash
  bool complete = false;
  std::vector<std::string> notes;  ///< what was lost or skipped, in words
};
Result<SessionLog> read_session_log(const std::filesystem::path& file);

}  // namespace mortise
