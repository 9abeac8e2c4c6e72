#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mortise {

/// A sparse map from index to value: open addressing, memory only for indices that were used. The
/// index 0xffffffff is not allowed. References are valid until the next insertion.
template <class Value>
class FlatMap {
 public:
  /// The value of an index, created when absent.
  Value& operator[](std::uint32_t index) {
    if (2 * (size_ + 1) > slots_.size()) grow();
    Slot& slot = slots_[place_of(index)];
    if (slot.index == kFree) {
      slot.index = index;
      ++size_;
    }
    return slot.value;
  }
  /// Null when absent.
  const Value* find(std::uint32_t index) const {
    if (slots_.empty()) return nullptr;
    const Slot& slot = slots_[place_of(index)];
    return slot.index == kFree ? nullptr : &slot.value;
  }
  std::size_t size() const { return size_; }

 private:
  static constexpr std::uint32_t kFree = 0xffffffffU;
  static constexpr std::size_t kFirstSize = 64;  // a power of two
  struct Slot {
    std::uint32_t index = kFree;
    Value value{};
  };

  // Fibonacci hashing (Knuth, vol. 3, 6.4): neighbouring indices land far apart.
  std::size_t place_of(std::uint32_t index) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t place = (index * 0x9e3779b97f4a7c15ULL >> 32) & mask;
    while (slots_[place].index != kFree && slots_[place].index != index) place = (place + 1) & mask;
    return place;
  }

  void grow() {
    std::vector<Slot> old(slots_.empty() ? kFirstSize : 2 * slots_.size());
    old.swap(slots_);
    for (Slot& slot : old)
      if (slot.index != kFree) slots_[place_of(slot.index)] = std::move(slot);
  }

  std::vector<Slot> slots_;
  std::size_t size_ = 0;
};

}  // namespace mortise
