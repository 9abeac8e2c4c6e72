#pragma once
#include "common/geometry/solid.h"
#include "common/motion/motion.h"
#include "common/session/memory/session_state.h"

namespace mortise {

/// The two parts of a pair and their motions in the tick.
struct MovingPair {
  const Solid* a = nullptr;
  const Solid* b = nullptr;
  Motion motion_a, motion_b;
};

/// Lower bound of the distance of the surfaces at every t of the motions, mm, from a distance that
/// was measured earlier (README, section 3): measured, minus the way between then and now of any
/// point of one part as seen from the other, minus the way within the tick. Negative when nothing
/// is known. OURS: counted from pose to pose instead of summed over ticks, so that parts carried
/// together and parts that come back spend nothing, and a teleport is a motion like any other.
double apart_lower_bound_mm(const PairMemo& memo, const MovingPair& query);

/// Upper bound of the way of any point of A seen from B within the motions, mm.
double relative_travel_upper_bound_mm(const MovingPair& query);

/// Notes that the surfaces are at least apart_mm from each other at these poses.
void remember_apart(PairMemo& memo, const Pose& X_WA, const Pose& X_WB, double apart_mm);

}  // namespace mortise
