#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "common/base/result.h"
#include "common/io/log/log_seal.h"

namespace mortise {

/// A new log file, written front to back. Errors of the disk stick: the file is cut back to what
/// was whole before, later calls do nothing, and error() says what happened. Not thread safe, but
/// for bytes_written().
class OutputFile {
 public:
  /// Fails when the file exists: a record of a session is never overwritten.
  static Result<std::unique_ptr<OutputFile>> create(const std::filesystem::path& file);
  /// Is the file being written by a living process of this host, or of another one where the disk
  /// between them supports flock()?
  static bool is_being_written(const std::filesystem::path& file);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// All of both or nothing.
  void write(std::span<const std::byte> bytes, std::span<const std::byte> more = {});
  /// Waits until all is on disk.
  Status sync();

  std::uint64_t bytes_written() const { return offset_.load(std::memory_order_relaxed); }
  std::uint32_t crc() const { return crc_; }  ///< of all since begin_crc()
  void begin_crc() { crc_ = 0; }
  std::string take_digest() { return digest_.take(); }  ///< of all since the last one
  const std::optional<Error>& error() const { return error_; }
  /// The log cannot be written any more: errno says why, `doing` at what.
  void set_error(const char* doing);

 private:
  OutputFile(int descriptor, std::string name);

  int descriptor_;
  std::string name_;
  std::optional<Error> error_;
  std::atomic<std::uint64_t> offset_ = 0;
  std::uint32_t crc_ = 0;
  RunningDigest digest_;
};

}  // namespace mortise
