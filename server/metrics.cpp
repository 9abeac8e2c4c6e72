#include "server/metrics.h"

#include <algorithm>
#include <bit>

#include "common/base/nearest_rank.h"

namespace mortise {

std::size_t DurationHistogram::bucket_of(std::uint64_t ns) {
  // Below 2 * kPerOctave a bucket is a nanosecond; above, the five bits after the leading one
  // choose it.
  if (ns < 2 * kPerOctave) return static_cast<std::size_t>(ns);
  const int shift = static_cast<int>(std::bit_width(ns)) - 6;
  const std::size_t bucket = static_cast<std::size_t>(shift) * kPerOctave + (ns >> shift);
  return std::min(bucket, std::size_t{kPerOctave * kOctaves - 1});
}

std::uint64_t DurationHistogram::top_of(std::size_t bucket) {
  if (bucket < 2 * kPerOctave) return bucket;
  const std::size_t shift = bucket / kPerOctave - 1;
  const std::uint64_t leading = bucket - shift * kPerOctave;
  return ((leading + 1) << shift) - 1;
}

void DurationHistogram::add(std::int64_t duration_ns) {
  const auto ns = static_cast<std::uint64_t>(std::max<std::int64_t>(duration_ns, 0));
  ++buckets_[bucket_of(ns)];
  ++count_;
  max_ns_ = std::max(max_ns_, ns);
  sum_s_ += static_cast<double>(ns) * 1e-9;
}

void DurationHistogram::clear() { *this = DurationHistogram{}; }

double DurationHistogram::percentile_us(double fraction) const {
  if (count_ == 0) return 0.0;
  const std::uint64_t wanted = nearest_rank(count_, fraction) + 1;
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < buckets_.size(); ++i) {
    seen += buckets_[i];
    if (seen >= wanted) {
      return static_cast<double>(std::min(top_of(i), max_ns_)) * 1e-3;
    }
  }
  return max_us();
}

std::uint64_t DurationHistogram::count_up_to(std::int64_t ns) const {
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < buckets_.size() && top_of(i) <= static_cast<std::uint64_t>(ns); ++i)
    seen += buckets_[i];
  return seen;
}

}  // namespace mortise
