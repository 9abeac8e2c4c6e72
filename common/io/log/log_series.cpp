#include "common/io/log/log_series.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mortise {

void add_event(DepthSeries& series, std::uint64_t clash, std::string_view kind, DepthPiece piece) {
  if (kind == "review") return;
  std::vector<DepthPiece>& pieces = series[clash];
  if (!pieces.empty()) pieces.back().to = piece.from;
  if (kind == "end") return;
  piece.least_mm = std::max(0.0, piece.least_mm);
  pieces.push_back(std::move(piece));
}

double largest_mm(const std::vector<DepthPiece>& pieces) {
  double mm = 1e-6;
  for (const DepthPiece& piece : pieces)
    for (const double x : {piece.least_mm, piece.fake_below_mm, piece.real_above_mm})
      if (std::isfinite(x)) mm = std::max(mm, x);
  return mm;
}

std::vector<TimeColumn> joined_columns(std::span<const TimeColumn> columns, std::size_t most) {
  const std::size_t together = (columns.size() + most - 1) / most;
  std::vector<TimeColumn> joined;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const TimeColumn& one = columns[i];
    if (i % together == 0) joined.push_back({one.from, one.from, 0.0, 0.0, 0.0});
    TimeColumn& all = joined.back();
    all.to = one.to;
    all.ticks += one.ticks;
    all.sum_us += one.sum_us;
    all.max_us = std::max(all.max_us, one.max_us);
  }
  return joined;
}

}  // namespace mortise
