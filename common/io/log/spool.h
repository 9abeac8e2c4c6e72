#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

#include "common/io/state/bytes.h"

namespace mortise {

/// Bytes that are appended and read once at the end. All but the last block of 4 KiB are in a file
/// without a name, so that memory does not grow. Where the folder has no such files, or the disk is
/// full, they stay in memory.
class Spool {
 public:
  static constexpr std::size_t kBlockBytes = 1 << 12;  ///< a page of memory

  /// The file is in `folder` and disappears with the process.
  explicit Spool(const std::filesystem::path& folder);
  ~Spool();
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  void append(std::span<const std::byte> bytes);
  std::uint64_t size() const { return on_disk_ + memory_.size(); }
  std::size_t in_memory() const { return memory_.size(); }

  /// All bytes in their order, in pieces. False when they cannot be read back: errno says why.
  bool read(const std::function<void(std::span<const std::byte>)>& take) const;

 private:
  bool write_out();

  int descriptor_;  ///< -1: none
  std::uint64_t on_disk_ = 0;
  ByteWriter memory_;
};

}  // namespace mortise
