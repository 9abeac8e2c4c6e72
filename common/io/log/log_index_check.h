#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/io/state/bytes.h"

namespace mortise {

/// What must stand behind the data of a closed log, made of the data alone: nobody needs to trust
/// the index of a file. Costs some 300 bytes a chunk.
class ExpectedIndex {
 public:
  /// The next record of the data, which begins at `at`.
  void record(std::uint64_t at, std::uint8_t opcode, std::span<const std::byte> content);
  /// End of data, index, footer and closing magic of a file whose data end at `at`.
  std::vector<std::byte> end(std::uint64_t at) const;

 private:
  void chunk(std::span<const std::byte> content);
  void message_index(std::uint64_t at, std::span<const std::byte> content);
  void attachment(std::uint64_t at, std::span<const std::byte> content);
  void metadata(std::uint64_t at, std::span<const std::byte> content);
  ByteWriter statistics() const;
  void end_chunk();

  struct Chunk {
    std::uint64_t at = 0, bytes = 0, index_bytes = 0;
    std::uint64_t start_time = 0, end_time = 0, stored = 0, size = 0;
    std::string compression;
    std::vector<std::pair<std::uint16_t, std::uint64_t>> offsets;  ///< of its message indexes
  };
  Chunk open_;                                 ///< whose message indexes are being read; at 0: none
  std::map<std::uint8_t, ByteWriter> groups_;  ///< records by opcode
  ByteWriter seals_;                           ///< their indexes stand behind other metadata
  std::map<std::uint16_t, std::uint64_t> messages_;
  std::uint64_t all_messages_ = 0, first_time_ = 0, last_time_ = 0;
  std::uint32_t schemas_ = 0, attachments_ = 0, metadata_ = 0, chunks_ = 0;
  std::uint32_t crc_ = 0;
  bool has_begun_ = false;
};

}  // namespace mortise
