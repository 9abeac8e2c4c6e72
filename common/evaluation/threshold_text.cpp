#include "common/evaluation/threshold_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/messages/length_text.h"

namespace mortise {
namespace {

constexpr const char *kFakeOverlap = "fake up to ", *kFakeGap = "fake from a gap of ";
constexpr const char *kRealOverlap = "real above ", *kRealGap = "real below a gap of ";

std::string text_of(double mm, const char* overlap, const char* gap) {
  const bool is_gap = mm < 0.0 && !reads_as_zero(mm);
  return (is_gap ? gap : overlap) + length_text(std::fabs(mm));
}

bool states(const std::string& explanation, double mm, const char* overlap, const char* gap) {
  return std::isfinite(mm) &&
         (reads_as_zero(mm) || explanation.find(overlap) != std::string::npos ||
          explanation.find(gap) != std::string::npos);
}

}  // namespace

std::string fake_text(double fake_below_mm) {
  return text_of(fake_below_mm, kFakeOverlap, kFakeGap);
}
std::string real_text(double real_above_mm) {
  return text_of(real_above_mm, kRealOverlap, kRealGap);
}

std::string probability_text(Interval p) {
  // Nearer to never and to always nobody trusts a distribution.
  constexpr double kLeast = 0.01, kMost = 99.9;
  const double lo = 100.0 * p.lo, hi = 100.0 * p.hi;
  char text[64];
  if (lo < kLeast)
    std::snprintf(text, sizeof text, "below %.3g %%", std::max(hi, kLeast));
  else if (hi > kMost)
    std::snprintf(text, sizeof text, "above %.3g %%", std::min(lo, kMost));
  else if (hi - lo <= std::pow(10.0, std::floor(std::log10(hi)) - 2.0))  // one of the third digit
    std::snprintf(text, sizeof text, "%.3g %%", 0.5 * (lo + hi));
  else
    std::snprintf(text, sizeof text, "%.3g to %.3g %%", lo, hi);
  return std::string("P(interference) ") + text;
}

bool states_fake(const std::string& explanation, double fake_below_mm) {
  return states(explanation, fake_below_mm, kFakeOverlap, kFakeGap);
}

bool states_real(const std::string& explanation, double real_above_mm) {
  return states(explanation, real_above_mm, kRealOverlap, kRealGap);
}

}  // namespace mortise
