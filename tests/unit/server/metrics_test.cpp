#include "server/metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace mortise {
namespace {

TEST(DurationHistogram, EmptySaysZero) {
  DurationHistogram histogram;
  EXPECT_EQ(histogram.percentile_us(0.99), 0.0);
  EXPECT_EQ(histogram.max_us(), 0.0);
}

TEST(DurationHistogram, PercentilesAreNeverTooLowAndAtMostAThirtySecondTooHigh) {
  std::mt19937_64 random(11);
  for (int octaves : {6, 20, 40}) {
    DurationHistogram histogram;
    std::vector<std::int64_t> values;
    for (int i = 0; i < 5000; ++i) {
      const auto value = static_cast<std::int64_t>(random() >> (64 - octaves + (i % 5)));
      values.push_back(value);
      histogram.add(value);
    }
    std::sort(values.begin(), values.end());
    for (double fraction : {0.01, 0.5, 0.9, 0.99, 0.999, 1.0}) {
      const auto rank = static_cast<std::size_t>(std::ceil(fraction * 5000.0)) - 1;
      const double exact_us = static_cast<double>(values[rank]) * 1e-3;
      EXPECT_GE(histogram.percentile_us(fraction), exact_us * (1 - 1e-12));
      EXPECT_LE(histogram.percentile_us(fraction), exact_us * (1.0 + 1.0 / 32.0) + 1e-9);
    }
    EXPECT_EQ(histogram.max_us(), static_cast<double>(values.back()) * 1e-3);
  }
}

TEST(DurationHistogram, CountsNothingBelowABoundThatIsAboveIt) {
  std::mt19937_64 random(12);
  DurationHistogram histogram;
  std::vector<std::int64_t> values;
  double sum_s = 0.0;
  for (int i = 0; i < 5000; ++i) {
    values.push_back(static_cast<std::int64_t>(random() % 100'000'000));
    histogram.add(values.back());
    sum_s += static_cast<double>(values.back()) * 1e-9;
  }
  for (const std::int64_t bound : {50'000, 1'000'000, 16'000'000, 50'000'000}) {
    const auto up_to = [&](std::int64_t ns) {
      return static_cast<std::uint64_t>(
          std::ranges::count_if(values, [ns](std::int64_t v) { return v <= ns; }));
    };
    EXPECT_LE(histogram.count_up_to(bound), up_to(bound));
    EXPECT_GE(histogram.count_up_to(bound), up_to(bound - bound / 32));
  }
  EXPECT_EQ(histogram.count_up_to(100'000'000'000), 5000U);
  EXPECT_NEAR(histogram.sum_s(), sum_s, 1e-9);
}

TEST(DurationHistogram, TakesWhatNoClockShouldSay) {
  DurationHistogram histogram;
  histogram.add(-5);
  histogram.add(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(histogram.count(), 2U);
  EXPECT_EQ(histogram.percentile_us(0.5), 0.0);
  EXPECT_GT(histogram.percentile_us(1.0), 1e9);
}

}  // namespace
}  // namespace mortise
