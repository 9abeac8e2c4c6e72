#pragma once
#include <cstdint>
#include <string>

namespace mortise {

/// Counts the end records of ticks in a file, which its writer numbered from 1: what was cut out
/// between two of them leaves a step in the numbers, and nothing else that shows.
class TickSequence {
 public:
  /// How many are missing before the one with this number; 0: none, or a writer that numbers none.
  std::uint64_t missing_before(std::uint32_t number) {
    const std::uint64_t missing = number > last_ + 1 ? number - last_ - 1 : 0;
    if (number > last_) last_ = number;
    return missing;
  }
  /// How many of so many are missing behind the last one.
  std::uint64_t missing_of(std::uint64_t all) const { return all > last_ ? all - last_ : 0; }

 private:
  std::uint64_t last_ = 0;
};

inline std::string missing_text(std::uint64_t ticks) {
  return std::to_string(ticks) + (ticks == 1 ? " recorded tick was" : " recorded ticks were") +
         " cut out of the file";
}

}  // namespace mortise
