#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/base/constants.h"
#include "common/base/ids.h"
#include "common/base/rare.h"
#include "common/io/state/bytes.h"
#include "common/math/types.h"

/// Serializes values and reads them back by one list of their members, `fields(archive, value)`,
/// see state_fields.h. Doubles keep every bit.
namespace mortise::state_bytes {

template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

template <class Archive, class T>
requires Plain<T>
void visit(Archive& archive, T& value) { archive.plain(value); }
template <class Archive, class Tag>
void visit(Archive& archive, Id<Tag>& id) {
  archive.plain(id.value);
}
template <class Archive>
void visit(Archive& archive, Vec3& v) {
  archive.plains(v.data(), 3);
}
template <class Archive>
void visit(Archive& archive, Quat& q) {
  archive.plains(q.coeffs().data(), 4);
}
template <class Archive>
void visit(Archive& archive, std::string& text) {
  archive.text(text);
}
template <class Archive, class T, std::size_t N>
void visit(Archive& archive, T (&values)[N]) {
  for (T& value : values) archive(value);
}
template <class Archive, class T, std::size_t N>
void visit(Archive& archive, std::array<T, N>& values) {
  for (T& value : values) archive(value);
}
template <class Archive, class A, class B>
void visit(Archive& archive, std::pair<A, B>& both) {
  archive(both.first, both.second);
}
template <class Archive, class Maybe>
void visit_maybe(Archive& archive, Maybe& value) {
  using T = std::remove_cvref_t<decltype(*value)>;
  bool has = value.has_value();
  archive(has);
  if (archive.reads() && has)
    value.emplace(T{});  // without it clang holds a nested T for incomplete
  if (archive.reads() && !has) value.reset();
  if (has) archive(*value);
}
template <class Archive, class T>
void visit(Archive& archive, std::optional<T>& value) {
  visit_maybe(archive, value);
}
template <class Archive, class T>
void visit(Archive& archive, Rare<T>& value) {
  visit_maybe(archive, value);
}
template <class Archive, class T>
void visit(Archive& archive, std::vector<T>& values) {
  const std::size_t count = archive.count(values.size());
  if (!archive.reads()) {
    for (T& value : values) archive(value);
    return;
  }
  values.clear();  // grows with what is really there, whatever the count says
  for (std::size_t i = 0; i < count && archive.ok(); ++i) archive(values.emplace_back());
}
template <class Archive, class K, class V>
void visit(Archive& archive, std::map<K, V>& values) {
  const std::size_t count = archive.count(values.size());
  if (!archive.reads()) {
    for (auto& [key, value] : values) {
      K copy = key;
      archive(copy, value);
    }
    return;
  }
  values.clear();
  for (std::size_t i = 0; i < count && archive.ok(); ++i) {
    std::pair<K, V> entry;
    archive(entry.first, entry.second);
    values.insert(std::move(entry));
  }
}
template <class Archive, class T>
requires std::is_class_v<T> && requires(Archive& archive, T& value) { fields(archive, value); }
void visit(Archive& archive, T& value) { fields(archive, value); }

class Writer {
 public:
  Writer() = default;
  /// Reuses the given memory.
  explicit Writer(std::vector<std::byte> memory) : bytes_(std::move(memory)) {}
  template <class... T>
  void operator()(const T&... values) {
    (visit(*this, const_cast<T&>(values)), ...);  // a writer changes nothing
  }
  static constexpr bool reads() { return false; }
  static constexpr bool ok() { return true; }
  template <class T>
  void plain(const T& value) {
    static_assert(std::endian::native == std::endian::little);
    std::memcpy(room(sizeof(T)), &value, sizeof(T));
  }
  template <class T>
  void plains(const T* values, std::size_t count) {
    std::memcpy(room(count * sizeof(T)), values, count * sizeof(T));
  }
  std::size_t count(std::size_t count) {
    plain(static_cast<std::uint32_t>(count));
    return count;
  }
  void text(const std::string& text) {
    count(text.size());
    append(std::as_bytes(std::span(text)));
  }
  void append(std::span<const std::byte> bytes) {
    if (!bytes.empty()) std::memcpy(room(bytes.size()), bytes.data(), bytes.size());
  }
  std::vector<std::byte> take() {
    bytes_.resize(std::exchange(size_, 0));
    return std::move(bytes_);
  }

 private:
  // Growing the vector for each number would cost more than writing it.
  std::byte* room(std::size_t bytes) {
    const std::size_t at = size_;
    size_ += bytes;
    if (size_ > bytes_.size()) bytes_.resize(std::max(2 * size_, kLeastRoom));
    return bytes_.data() + at;
  }

  static constexpr std::size_t kLeastRoom = 256;  // bytes; then it doubles
  std::vector<std::byte> bytes_;                  ///< with room behind what is written
  std::size_t size_ = 0;
};

/// Never reads past its end: the first value that does not fit makes ok() false, and it and all
/// after it are zero. So does a vector that is not finite or longer than any coordinate.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : in_(bytes) {}
  template <class... T>
  void operator()(T&... values) {
    (visit(*this, values), ...);
  }
  static constexpr bool reads() { return true; }
  bool ok() const { return in_.ok() && sensible_; }
  bool at_end() const { return sensible_ && in_.at_end(); }
  template <class T>
  void plain(T& value) {
    const auto bytes = in_.raw(sizeof(T));
    if constexpr (std::is_same_v<T, bool>) {
      value = !bytes.empty() && bytes.front() != std::byte{0};
    } else {
      value = T{};
      if (!bytes.empty()) std::memcpy(&value, bytes.data(), sizeof(T));
    }
  }
  template <class T>
  void plains(T* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      plain(values[i]);
      sensible_ &= std::islessequal(std::abs(values[i]), kLargestCoordinate_mm);
    }
  }
  /// Every item takes at least one byte; a count larger than that allows becomes 0.
  std::size_t count(std::size_t) {
    std::uint32_t count = 0;
    plain(count);
    return in_.room_for(count, 1) ? count : 0;
  }
  void text(std::string& text) { text = in_.text(count(0)); }

 private:
  ByteReader in_;
  bool sensible_ = true;
};

}  // namespace mortise::state_bytes
