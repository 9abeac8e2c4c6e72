#include "common/evaluation/verdict.h"

#include "common/base/check.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

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
  MORTISE_CHECK(
      input.delta_mm.ordered() && input.certain_mm.ordered() && input.possible_mm.ordered(),
      "a class is made of brackets with their lower ends first");
  const bool never = input.possible_mm.hi <= 0.0;
  if (!meshes_overlap(input) && never) return CollisionClass::kNone;
  if (input.no_inside) return CollisionClass::kPotential;
  if (never) return CollisionClass::kFake;
  return input.certain_mm.lo > 0.0 && input.has_witness ? CollisionClass::kReal
                                                        : CollisionClass::kPotential;
}

}  // namespace mortise
