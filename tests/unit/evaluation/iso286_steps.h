#pragma once
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "common/evaluation/iso286.h"

/// Limits in micrometres and the steps of nominal size, for the tests of the standard's tables.
namespace mortise {

inline constexpr std::array<double, 13> kMainEnds_mm{3,   6,   10,  18,  30,  50, 80,
                                                     120, 180, 250, 315, 400, 500};
inline constexpr std::array<double, 25> kFineEnds_mm{3,   6,   10,  14,  18,  24,  30,  40,  50,
                                                     65,  80,  100, 120, 140, 160, 180, 200, 225,
                                                     250, 280, 315, 355, 400, 450, 500};

template <std::size_t N>
double lower_end(const std::array<double, N>& ends_mm, std::size_t step) {
  return step == 0 ? 1.0 : ends_mm[step - 1];
}

/// A size that no longer belongs to the step which ends here.
inline double just_above(double end_mm) { return end_mm * (1.0 + 1e-9) + 1e-3; }

/// The size that the standard's formulas take for a step.
template <std::size_t N>
double geometric_mean(const std::array<double, N>& ends_mm, std::size_t step) {
  return std::sqrt(lower_end(ends_mm, step) * ends_mm[step]);
}

inline Interval limits_um(const std::string& code, double nominal_mm) {
  const auto limits = iso286_limits(code, nominal_mm);
  EXPECT_TRUE(limits) << code << " " << nominal_mm << ": " << (limits ? "" : limits.error().text);
  return limits ? Interval{limits->deviation_mm.lo * 1e3, limits->deviation_mm.hi * 1e3}
                : Interval{NAN, NAN};
}
inline double lower_um(const std::string& code, double nominal_mm) {
  return limits_um(code, nominal_mm).lo;
}
inline double upper_um(const std::string& code, double nominal_mm) {
  return limits_um(code, nominal_mm).hi;
}

}  // namespace mortise
