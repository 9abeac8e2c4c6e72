#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace mortise {

/// 128-bit content hash (XXH3) of bytes, as 32 hex digits. Names meshes and scenarios; not a
/// defence against forgery.
std::string content_hash(std::span<const std::byte> bytes);

/// Running 64-bit hash (XXH3) of the state of a session; the same bytes in the same order give the
/// same value on every build. Feed values, never structs with padding.
class StateHash {
 public:
  void add(std::span<const std::byte> bytes);
  void add(double value);  ///< -0.0 is hashed as 0.0
  void add(std::uint64_t value);
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0;
};

}  // namespace mortise
