#pragma once
#include <algorithm>
#include <limits>

namespace mortise {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// lo <= true value <= hi.
struct Interval {
  double lo = 0.0;
  double hi = 0.0;

  double width() const { return hi - lo; }
  double middle() const { return 0.5 * (lo + hi); }
  bool contains(double x) const { return lo <= x && x <= hi; }
  /// lo <= hi; no number is neither.
  bool ordered() const { return lo <= hi; }
  friend Interval operator+(Interval a, Interval b) { return {a.lo + b.lo, a.hi + b.hi}; }
  friend Interval operator-(Interval a) { return {-a.hi, -a.lo}; }
  friend bool operator==(const Interval&, const Interval&) = default;
};

inline Interval hull(Interval a, Interval b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}

}  // namespace mortise
