#pragma once
#include <vector>

#include "common/depth/depth.h"
#include "common/evaluation/verdict.h"
#include "common/session/world/world.h"

namespace mortise {

/// One pair at its target poses: depth, thresholds and verdict (stage 4 of the tick).
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
  /// Of the whole judgement; beyond it the generalized depth keeps its first, wide bracket.
  std::uint64_t whole_cap = 1'000'000;
};

struct Judgement {
  std::vector<Verdict> verdicts;        ///< classes other than kNone, worst first
  std::vector<std::size_t> of_regions;  ///< the region of each verdict
  OverlapResult overlap;
};

/// Bands of the pair: those of the rule if it has them, else those of the parts.
const SurfaceBand& band_a_of(const JudgementQuery& query);
const SurfaceBand& band_b_of(const JudgementQuery& query);

Judgement judge_pair(const JudgementQuery& query, CcdScratch& scratch);

/// Adds what want_gpd asks for to a judgement that was made without it by the same query.
void add_depths(const JudgementQuery& query, Judgement& judgement, CcdScratch& scratch);

/// The generalized depth of the pair made smallest and made largest, beside what was judged of it:
/// of a fake both are zero, and what is certain is a part of the first. Not of parts without an
/// inside.
LayerDepths depths_of_layers(const JudgementQuery& query, const Judgement& judgement,
                             CcdScratch& scratch);

/// Adds the counters of one judgement.
void count(const JudgementQuery& query, const Judgement& judgement, StepCounters& counts);

}  // namespace mortise
