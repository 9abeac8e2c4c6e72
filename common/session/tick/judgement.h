#pragma once
#include <vector>

#include "common/depth/generalized_depth.h"
#include "common/depth/overlap.h"
#include "common/evaluation/verdict.h"
#include "common/session/world/world.h"

namespace mortise {

/// One pair at its target poses, depth, thresholds and verdict in one go (stage 4 of the tick).
struct JudgementQuery {
  const Part* a = nullptr;
  const Part* b = nullptr;
  const PairRule* rule = nullptr;  ///< may be null
  Motion motion_a,
      motion_b;  ///< of the tick, ending at the poses to judge; still when nothing moved
  double t_contact = 1.0;
  Refinement refinement = Refinement::kDecided;
  bool want_gpd = true;
  std::uint64_t work_cap = 200'000;  ///< of the overlap, see OverlapQuery
  /// Of everything; beyond it the generalized depth keeps the bracket that costs nothing.
  std::uint64_t whole_cap = 1'000'000;
};

struct Judgement {
  std::vector<Verdict> verdicts;  ///< classes other than kNone, worst first
  OverlapResult overlap;
};

/// Bands of the pair: the rule's where it has them, else the parts' own.
const SurfaceBand& band_a_of(const JudgementQuery& query);
const SurfaceBand& band_b_of(const JudgementQuery& query);

Judgement judge_pair(const JudgementQuery& query, CcdScratch& scratch);

/// Adds what one judgement asked and found.
void count(const JudgementQuery& query, const Judgement& judgement, StepCounters& counts);

}  // namespace mortise
