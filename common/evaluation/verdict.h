#pragma once
#include "common/math/interval.h"
#include "common/messages/verdict.h"

namespace mortise {

/// The paper's two thresholds on the overlap delta. fake_below <= real_above always.
struct Thresholds {
  double fake_below_mm = 0.0;
  double real_above_mm = 0.0;
};

/// delta > real_above <=> sup(delta + lower offsets) > 0; likewise fake_below with the upper
/// offsets. mm.
Thresholds thresholds_of(Interval delta_mm, Interval certain_mm, Interval possible_mm);

/// Total and exhaustive: real iff certain.lo > 0 (and a witness was verified), fake iff possible.hi
/// <= 0 and the meshes overlap, none iff possible.hi <= 0 and they do not, else potential. A part
/// without an inside is potential at best.
struct ClassifyInput {
  Interval delta_mm, certain_mm, possible_mm;
  bool has_witness = false;
  bool no_inside = false;
};
CollisionClass classify(const ClassifyInput& input);

}  // namespace mortise
