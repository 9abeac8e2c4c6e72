#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

/// RTPS 2.3 as bytes, as far as we read datagrams ourselves.
namespace mortise::rtps_wire {

// Sections 8.3 and 9.4: header of 20 bytes, then submessages with a header of 4.
inline constexpr std::size_t kHeaderSize = 20;
inline constexpr std::size_t kSubmessageHeaderSize = 4;
inline constexpr std::uint8_t kDataSubmessage = 0x15;
inline constexpr std::uint16_t kOctetsToInlineQos = 16;  ///< of DATA, fixed in RTPS 2.x

// Parameters, section 9.6.2.2.
inline constexpr std::uint16_t kSentinel = 1;  ///< ends a parameter list
inline constexpr std::uint16_t kUserData = 0x2c;

/// A submessage's body, or a part of it, in its own byte order. Offsets are checked by the caller
/// through has().
struct Bytes {
  std::span<const std::byte> data;
  bool little = true;

  bool has(std::size_t size) const { return data.size() >= size; }
  std::uint8_t u8(std::size_t at) const { return std::to_integer<std::uint8_t>(data[at]); }
  std::uint16_t u16(std::size_t at) const {
    const unsigned a = u8(at), b = u8(at + 1);
    return static_cast<std::uint16_t>(little ? a | b << 8 : b | a << 8);
  }
  std::uint32_t u32(std::size_t at) const {
    const std::uint32_t a = u16(at), b = u16(at + 2);
    return little ? a | b << 16 : b | a << 16;
  }
  /// A sequence number: signed high word, unsigned low word.
  std::int64_t sequence(std::size_t at) const {
    const auto high = static_cast<std::int64_t>(static_cast<std::int32_t>(u32(at)));
    return high * (std::int64_t{1} << 32) + static_cast<std::int64_t>(u32(at + 4));
  }
};

}  // namespace mortise::rtps_wire
