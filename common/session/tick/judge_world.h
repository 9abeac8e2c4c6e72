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
};
struct JudgeReport {
  std::vector<PairVerdicts> pairs;  ///< pairs with at least one verdict, and excluded ones
  StepCounters counters;
};
JudgeReport judge_world(World& world, Scratch& scratch, bool full_brackets);

}  // namespace mortise
