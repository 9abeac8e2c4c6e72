#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/plain_text.h"

namespace mortise {

/// Little-endian output into a growing buffer.
class ByteWriter {
 public:
  void u8(std::uint8_t value) { bytes_.push_back(static_cast<std::byte>(value)); }
  void u16(std::uint16_t value) { little_endian(value, 2); }
  void u32(std::uint32_t value) { little_endian(value, 4); }
  void u64(std::uint64_t value) { little_endian(value, 8); }
  void f32(float value) { u32(std::bit_cast<std::uint32_t>(value)); }
  void f64(double value) { u64(std::bit_cast<std::uint64_t>(value)); }
  /// Seven bits a byte, lowest first, high bit: more follow (LEB128).
  void varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) u8(static_cast<std::uint8_t>(value | 0x80));
    u8(static_cast<std::uint8_t>(value));
  }
  void raw(std::span<const std::byte> data) {
    bytes_.insert(bytes_.end(), data.begin(), data.end());
  }
  void raw(std::string_view text) { raw(std::as_bytes(std::span(text))); }
  /// Length as u32, then the bytes.
  void string(std::string_view text) {
    u32(static_cast<std::uint32_t>(text.size()));
    raw(text);
  }

  std::span<const std::byte> bytes() const { return bytes_; }
  std::size_t size() const { return bytes_.size(); }
  bool empty() const { return bytes_.empty(); }
  void clear() { bytes_.clear(); }
  void reserve(std::size_t size) { bytes_.reserve(size); }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  void little_endian(std::uint64_t value, int count) {
    for (int i = 0; i < count; ++i) u8(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  std::vector<std::byte> bytes_;
};

/// Little-endian input that never reads past its end: the first value that does not fit makes ok()
/// false, and it and all after it are zero or empty.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::uint8_t u8() { return static_cast<std::uint8_t>(little_endian(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(little_endian(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(little_endian(4)); }
  std::uint64_t u64() { return little_endian(8); }
  float f32() { return std::bit_cast<float>(u32()); }
  double f64() { return std::bit_cast<double>(u64()); }
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const std::uint8_t byte = u8();
      value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
      if (byte < 0x80) return value;
    }
    ok_ = false;  // more than ten bytes: no varint of ours
    return 0;
  }
  /// A varint that must fit into 32 bits.
  std::uint32_t varint32() {
    const std::uint64_t value = varint();
    if (value > UINT32_MAX) ok_ = false;
    return ok_ ? static_cast<std::uint32_t>(value) : 0;
  }
  std::span<const std::byte> raw(std::uint64_t length) {
    if (length > bytes_.size()) ok_ = false;
    if (!ok_) return {};
    const auto taken = bytes_.first(static_cast<std::size_t>(length));
    bytes_ = bytes_.subspan(static_cast<std::size_t>(length));
    return taken;
  }
  std::string string() { return text(u32()); }
  /// So many bytes as text; what is not UTF-8 in them is replaced: a damaged file must not break
  /// what it is told in.
  std::string text(std::uint64_t length) {
    const auto data = raw(length);
    return as_utf8({reinterpret_cast<const char*>(data.data()), data.size()});
  }
  /// Is there room for `count` items of at least `least_bytes` each? Else ok() becomes false: asked
  /// before anything is allocated for them.
  bool room_for(std::uint64_t count, std::uint64_t least_bytes) {
    if (count > bytes_.size() / least_bytes) ok_ = false;
    return ok_;
  }

  bool ok() const { return ok_; }
  std::size_t left() const { return ok_ ? bytes_.size() : 0; }
  bool at_end() const { return ok_ && bytes_.empty(); }

 private:
  std::uint64_t little_endian(std::size_t count) {
    const auto data = raw(count);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < data.size(); ++i)
      value |= std::to_integer<std::uint64_t>(data[i]) << (8 * i);
    return value;
  }
  std::span<const std::byte> bytes_;
  bool ok_ = true;
};

}  // namespace mortise
