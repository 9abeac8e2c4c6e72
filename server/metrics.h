#pragma once
#include <array>
#include <cstdint>

namespace mortise {

/// Distribution of durations: buckets of 1/32 octave from 1 ns to 2^48 ns, so that a percentile is
/// at most 3.2 % too high and never too low. Fixed size, no allocation.
class DurationHistogram {
 public:
  void add(std::int64_t duration_ns);
  void clear();
  std::uint64_t count() const { return count_; }
  /// Upper bound of the smallest duration that a `fraction` of all do not exceed; 0 when empty.
  double percentile_us(double fraction) const;
  double max_us() const { return static_cast<double>(max_ns_) * 1e-3; }
  double sum_s() const { return sum_s_; }
  /// How many are certainly not longer: those less than 3.2 % below `ns` may be missing.
  std::uint64_t count_up_to(std::int64_t ns) const;

 private:
  /// A bucket is 1/32 of its lower end wide, 3.2 %; 48 octaves of them reach to 2^52 ns, 52 days.
  static constexpr int kPerOctave = 32;
  static constexpr int kOctaves = 48;
  static std::size_t bucket_of(std::uint64_t ns);
  static std::uint64_t top_of(std::size_t bucket);

  std::array<std::uint32_t, kPerOctave * kOctaves> buckets_{};
  std::uint64_t count_ = 0;
  std::uint64_t max_ns_ = 0;
  double sum_s_ = 0.0;
};

/// Where the time of the ticks went.
struct TickMetrics {
  DurationHistogram tick;      ///< drain to publish
  DurationHistogram step;      ///< the engine's part
  DurationHistogram lateness;  ///< start of a tick after its deadline
  /// From send to the tick, beyond the fastest increment of the same sender so far: clocks of two
  /// machines cannot be compared, the spread can. One sample a user and tick.
  DurationHistogram delay;
  std::uint64_t ticks = 0;
  std::uint64_t overloads = 0;         ///< ticks that ran past the next deadline
  std::uint64_t missed_deadlines = 0;  ///< deadlines passed over because of them
};

}  // namespace mortise
