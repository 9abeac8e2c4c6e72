#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace mortise {

/// CRC-32 of ISO 3309 (polynomial 0xEDB88320 reflected), the one of MCAP, gzip and PNG.
/// crc32(b, crc32(a)) is the CRC of a followed by b.
std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before = 0);

}  // namespace mortise
