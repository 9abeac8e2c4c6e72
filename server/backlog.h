#pragma once
#include <algorithm>
#include <cstdint>

namespace mortise {

/// The ticks that the standby has received and not computed yet. They are safe, but at a take-over
/// users would wait until they are computed.
class Backlog {
 public:
  /// At 60 Hz half a second, and a tenth. A tick of a full budget is 3 of them.
  static constexpr std::uint64_t kBehind_ticks = 30, kInStep_ticks = 6;
  enum class News { kNone = 0, kInStep, kBehind, kInStepAgain };

  /// Sets the present number and returns what has changed by it.
  News now_is(std::uint64_t ticks) {
    ticks_ = ticks;
    longest_ticks_ = std::max(longest_ticks_, ticks);
    if (in_step_ && ticks > kBehind_ticks) {
      in_step_ = false;
      ++times_behind_;
      return News::kBehind;
    }
    if (in_step_ || ticks > kInStep_ticks) return News::kNone;
    in_step_ = true;
    const bool again = was_in_step_;
    was_in_step_ = true;
    return again ? News::kInStepAgain : News::kInStep;
  }
  /// The standby is gone; another one may come.
  void forget() {
    in_step_ = was_in_step_ = false;
    ticks_ = 0;
  }

  bool in_step() const { return in_step_; }
  std::uint64_t ticks() const { return ticks_; }
  std::uint64_t longest_ticks() const { return longest_ticks_; }
  std::uint64_t times_behind() const { return times_behind_; }

 private:
  bool in_step_ = false, was_in_step_ = false;
  std::uint64_t ticks_ = 0, longest_ticks_ = 0, times_behind_ = 0;
};

}  // namespace mortise
