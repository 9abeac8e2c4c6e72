#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

/// Names of the MCAP container (https://mcap.dev/spec): an open format of recorded messages.
namespace mortise::mcap {

/// At both ends of a file; fixed by the specification.
inline constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'M', 'C', 'A', 'P', 0x30, '\r', '\n'};

enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

/// Opcode and length before each record.
inline constexpr std::size_t kRecordHeaderBytes = 1 + 8;
/// Two offsets and a CRC; fixed by the specification.
inline constexpr std::size_t kFooterBytes = 8 + 8 + 4;
/// Chunk without compression name and records: two times, size, CRC, length of the name, of the
/// records.
inline constexpr std::size_t kChunkFixedBytes = 8 + 8 + 8 + 4 + 4 + 8;

}  // namespace mortise::mcap
