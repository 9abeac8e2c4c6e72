#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace mortise {

/// A regular file, read in pieces from anywhere. A file that shrinks while it is read gives short
/// pieces, never an error signal.
class InputFile {
 public:
  explicit InputFile(const std::filesystem::path& file);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  bool is_open() const { return open_; }  ///< else errno says why
  std::uint64_t size() const { return size_; }
  /// Reads as much of [offset, offset + length) as the file has, into `buffer`, which only grows.
  std::span<const std::byte> read(std::uint64_t offset, std::uint64_t length,
                                  std::vector<std::byte>& buffer) const;
  std::uint64_t bytes_read() const { return bytes_read_; }  ///< in all

 private:
  int descriptor_;
  bool open_ = false;
  std::uint64_t size_ = 0;
  mutable std::uint64_t bytes_read_ = 0;
};

}  // namespace mortise
