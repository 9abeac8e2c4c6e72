#include "common/evaluation/threshold_text.h"

#include <cmath>

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

bool states_fake(const std::string& explanation, double fake_below_mm) {
  return states(explanation, fake_below_mm, kFakeOverlap, kFakeGap);
}

bool states_real(const std::string& explanation, double real_above_mm) {
  return states(explanation, real_above_mm, kRealOverlap, kRealGap);
}

}  // namespace mortise
