#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>

#include "common/depth/pair_path.h"

namespace mortise {

/// Over which part of a tick a bound that is convex in the displacement keeps two faces from
/// interfering.
struct Exclusion {
  static constexpr int kMostAsked = 200;  ///< bounds; then nothing more is excluded
  const PairPath& path;
  double touch_mm = 0.0;
  double moment = 0.0;                        ///< the briefest interval, of the tick
  static constexpr std::uint64_t kWork = 10;  ///< evaluations that a bound counts for
  std::uint64_t work() const { return kWork * static_cast<std::uint64_t>(asked); }
  int asked = 0;  ///< bounds so far
  /// Largest bound over the intervals that were excluded, mm.
  double most_mm = -std::numeric_limits<double>::infinity();

  /// The first interval, as brief as `moment`, over which the bound exceeds touch; [1, 1]: none.
  /// overlap_over(span, t): the bound at time t for everything that is near at any time of the
  /// span. A convex bound is largest at one of the two ends, up to the curvature of the path.
  template <class OverlapOver>
  Span first(const OverlapOver& overlap_over) {
    const Span begin{0.0, std::min(1.0, moment)};
    if (overlap_over(begin, 0.0) > touch_mm) return begin;
    return first(overlap_over, {0.0, 1.0});
  }

 private:
  template <class OverlapOver>
  Span first(const OverlapOver& overlap_over, const Span& span) {
    if (asked >= kMostAsked) return span;
    asked += 2;
    const double most = std::max(overlap_over(span, span.t0), overlap_over(span, span.t1)) +
                        path.spread(0, span) + path.spread(1, span);
    if (most <= touch_mm) {
      most_mm = std::max(most_mm, most);
      return {1.0, 1.0};
    }
    const double middle = 0.5 * (span.t0 + span.t1);
    if (span.t1 - span.t0 <= moment || !(middle > span.t0) || !(middle < span.t1)) return span;
    const Span early = first(overlap_over, {span.t0, middle});
    return early.t0 < 1.0 ? early : first(overlap_over, {middle, span.t1});
  }
};

}  // namespace mortise
