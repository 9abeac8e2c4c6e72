#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "common/io/log/log_json.h"
#include "common/io/log/mcap_writer.h"
#include "common/io/log/session_log.h"

namespace mortise {

/// One file of a session log as it is written: its head, then ticks. Not thread safe; private to
/// session_log.
class LogFile {
 public:
  /// Writes the head, waits until it is on disk, and only then gives the file its name. Fails when
  /// a file of that name exists.
  static Result<std::unique_ptr<LogFile>> create(const std::filesystem::path& file,
                                                 const LogHeader& header,
                                                 const LogOptions& options);

  /// Is there a file that has not got its name yet, also one left by an interrupted start?
  static bool is_begun(const std::filesystem::path& file);
  /// Gives the file its name, with LogOptions::named_later.
  Status take_name();
  /// The same for a closed file.
  static Status name(const std::filesystem::path& file);
  static void remove_unnamed(const std::filesystem::path& file);
  /// Removes the file if it never got its name.
  void remove_if_unnamed();
  void write(const std::string& mesh_hash, const TriangleMesh& mesh);
  void write(const TickRecord& tick);
  void write(const Checkpoint& state);
  void write_gap(const log_json::Gap& gap);
  void write_statistics();
  /// Ends the open chunk, and seals it: session_log_format.md, "Seals".
  void end_chunk();
  Status sync();  ///< and waits until all is on disk
  /// Adds a second front, the last seal, index and footer.
  Status close(const LogHeader& header);
  const std::string& seal() const { return seal_; }  ///< digest of the last one

  /// The time of records written from now on; never falls.
  void set_time(std::int64_t time_ns);
  std::uint64_t time_ns() const { return time_ns_; }
  const std::filesystem::path& path() const { return path_; }
  McapWriter& mcap() { return *mcap_; }
  const McapWriter& mcap() const { return *mcap_; }

 private:
  LogFile(std::unique_ptr<McapWriter> mcap, std::filesystem::path path,
          std::shared_ptr<const LogSigner> signer)
      : mcap_(std::move(mcap)), path_(std::move(path)), signer_(std::move(signer)) {}
  void write_head(const LogHeader& header);
  void add_seal(bool is_last);
  void message(std::uint16_t channel, std::span<const std::byte> data);
  void message(std::uint16_t channel, const std::string& text);

  std::unique_ptr<McapWriter> mcap_;
  std::filesystem::path path_;
  std::shared_ptr<const LogSigner> signer_;
  std::string seal_;
  std::uint64_t seals_ = 0;
  std::uint16_t decisions_ = 0, increments_ = 0, poses_ = 0, clashes_ = 0, ticks_ = 0,
                statistics_ = 0, gaps_ = 0, checkpoints_ = 0, totals_ = 0;
  std::uint64_t time_ns_ = 0, statistics_time_ns_ = 0;
  bool has_time_ = false, named_ = false;
  log_json::CounterSums sums_;
};

}  // namespace mortise
