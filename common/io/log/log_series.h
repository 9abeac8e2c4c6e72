#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mortise {

// What a session was like over time, for plots in reports and in the page. Times are in whatever
// the caller counts.

/// One clash from an event to the next, or to its end.
struct DepthPiece {
  double from = 0.0, to = 0.0;
  double least_mm = 0.0, most_mm = 0.0;  ///< of the overlap; most: not finite where not bounded
  double fake_below_mm = 0.0, real_above_mm = 0.0;
  std::string klass;
};

/// By clash, in the order of time.
using DepthSeries = std::map<std::uint64_t, std::vector<DepthPiece>>;

/// Takes in an event of this kind (by its name) at `piece.from`; `piece.to`: the end of all.
void add_event(DepthSeries& series, std::uint64_t clash, std::string_view kind, DepthPiece piece);

/// The deepest that is certain, and the thresholds as far as they are known: the scale of a plot.
double largest_mm(const std::vector<DepthPiece>& pieces);

/// What ticks took in a stretch of time.
struct TimeColumn {
  double from = 0.0, to = 0.0, ticks = 0.0, sum_us = 0.0, max_us = 0.0;
  double mean_us() const { return sum_us / ticks; }
};

/// So many neighbours together that there are not more than `most`.
std::vector<TimeColumn> joined_columns(std::span<const TimeColumn> columns, std::size_t most);

}  // namespace mortise
