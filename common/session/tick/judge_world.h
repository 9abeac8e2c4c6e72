#pragma once
#include <vector>

#include "common/session/tick/step.h"

namespace mortise {

/// Judges every pair at the present poses without moving anything (what `mortise judge` shows).
struct PairVerdicts {
  PartId a, b;
  std::vector<Verdict> verdicts;  ///< a region each, worst first
  double distance_mm = 0.0;       ///< of the meshes when they do not cross
  bool excluded = false;
  bool no_inside = false;
  /// One lies where the inside of the other is not known: nobody can say that they are apart.
  bool not_examined = false;
  /// The pair whose verdicts these are, moved here; none: judged itself.
  PartId like_a, like_b;
};
struct JudgeReport {
  /// Pairs with at least one verdict, those not examined, and excluded ones.
  std::vector<PairVerdicts> pairs;
  StepCounters counters;
};

/// Pairs of parts of the same kinds that stand to each other in the same way (to a nanometre over
/// the parts) are judged once, where `alike_once` is set; their verdicts are moved to the others.
/// Only pairs without a rule of their own are alike.
JudgeReport judge_world(World& world, Scratch& scratch, bool full_brackets,
                        bool alike_once = false);

}  // namespace mortise
