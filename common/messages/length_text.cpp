#include "common/messages/length_text.h"

#include <cmath>
#include <cstdio>

namespace mortise {
namespace {

constexpr double kUmPerMm = 1e3;
constexpr double kShown_um = 0.05;      // tenths are shown: less is nothing
constexpr double kLeastMm_um = 999.95;  // what rounds to 1000.0 µm is said in mm
// A bracket as narrow as depth refines it (0.1 µm) reads as one number.
constexpr double kBracketShown_um = 0.11;

struct SaidLength {
  std::string number;
  const char* unit;
};

SaidLength said_length(double mm) {
  char text[352];  // of the largest double
  const double um = mm * kUmPerMm;
  if (std::fabs(um) >= kLeastMm_um) {
    std::snprintf(text, sizeof text, "%.3f", mm);
    return {text, " mm"};
  }
  std::snprintf(text, sizeof text, "%.1f", std::fabs(um) < kShown_um ? 0.0 : um);
  return {text, " µm"};
}

}  // namespace

bool reads_as_zero(double mm) { return std::fabs(mm) * kUmPerMm < kShown_um; }

std::string length_text(double mm) {
  if (!std::isfinite(mm)) return "unbounded";
  const SaidLength length = said_length(mm);
  return length.number + length.unit;
}

std::string range_text(Interval mm) {
  if (!std::isfinite(mm.hi)) return "at least " + length_text(mm.lo);
  if (!std::isfinite(mm.lo)) return "at most " + length_text(mm.hi);
  if (mm.width() * kUmPerMm <= kBracketShown_um) return length_text(mm.middle());
  const SaidLength lo = said_length(mm.lo), hi = said_length(mm.hi);
  if (std::string(lo.unit) != hi.unit) return length_text(mm.lo) + " to " + length_text(mm.hi);
  return (lo.number == hi.number ? lo.number : lo.number + " to " + hi.number) + hi.unit;
}

}  // namespace mortise
