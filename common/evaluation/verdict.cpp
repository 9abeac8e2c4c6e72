#include "common/evaluation/verdict.h"

#include <algorithm>
#include <cmath>

#include "common/messages/names.h"

namespace mortise {
namespace {

// Limits of a tolerance count as three standard deviations on either side.
constexpr double kSigmasPerWidth = 6.0;

bool meshes_overlap(const ClassifyInput& input) { return input.delta_mm.hi > 0.0; }

}  // namespace

Thresholds thresholds_of(Interval delta_mm, Interval certain_mm, Interval possible_mm) {
  Thresholds thresholds;
  thresholds.real_above_mm = delta_mm.lo - certain_mm.lo;
  thresholds.fake_below_mm = delta_mm.hi - possible_mm.hi;
  if (thresholds.fake_below_mm <= thresholds.real_above_mm) return thresholds;
  // Wide brackets can cross. The threshold that decided keeps its place, the other joins it.
  if (possible_mm.hi <= 0.0)
    thresholds.real_above_mm = thresholds.fake_below_mm;
  else
    thresholds.fake_below_mm = thresholds.real_above_mm;
  return thresholds;
}

CollisionClass classify(const ClassifyInput& input) {
  const bool never = input.possible_mm.hi <= 0.0;
  if (!meshes_overlap(input) && never) return CollisionClass::kNone;
  if (input.no_inside) return CollisionClass::kPotential;
  if (never) return CollisionClass::kFake;
  return input.certain_mm.lo > 0.0 && input.has_witness ? CollisionClass::kReal
                                                        : CollisionClass::kPotential;
}

double interference_probability(Interval certain_mm, Interval possible_mm, Interval tolerance_a_mm,
                                Interval tolerance_b_mm) {
  // Lower ends are reached at a point, whereas upper ends may stay wide once the class is decided.
  const double lo = certain_mm.lo;
  const double hi = std::max(possible_mm.lo, lo);
  // What the tolerances do not explain is doubt about the mesh; it counts as one more such part.
  const double doubt = std::max(0.0, hi - lo - tolerance_a_mm.width() - tolerance_b_mm.width());
  const double sigma =
      std::hypot(tolerance_a_mm.width(), tolerance_b_mm.width(), doubt) / kSigmasPerWidth;
  const double mean = 0.5 * (lo + hi);
  if (sigma <= 0.0) return mean > 0.0 ? 1.0 : mean < 0.0 ? 0.0 : 0.5;
  return 0.5 * std::erfc(-mean / (sigma * std::sqrt(2.0)));
}

}  // namespace mortise
