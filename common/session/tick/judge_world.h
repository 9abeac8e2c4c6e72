#pragma once
#include <array>
#include <vector>

#include "common/broadphase/broad_phase.h"
#include "common/depth/depth.h"
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
  /// The generalized depth of the least and of the largest bodies; with full brackets only.
  LayerDepths layers;
  /// The pair whose verdicts these are, moved here; none: judged itself.
  PartId like_a, like_b;
};
struct JudgeReport {
  /// Pairs with at least one verdict, those not examined, and excluded ones.
  std::vector<PairVerdicts> pairs;
  StepCounters counters;
};
JudgeReport judge_world(World& world, Scratch& scratch, bool full_brackets);

/// The same for a large assembly.
struct AssemblyJudgement {
  JudgeReport report;
  /// Candidates that have no verdict: their boxes meet, they do not. In the order of their numbers.
  std::vector<IndexPair> without_verdict;
};
/// Pairs of parts of the same kinds that stand to each other in the same way (to a nanometre over
/// the parts) are judged once; their verdicts are moved to the others. Only pairs without a rule of
/// their own are alike. `work_cap`: of one overlap, see OverlapQuery. Ways out are left open, which
/// takes as long as all the rest: tell_pair is for the pairs that somebody reads.
AssemblyJudgement judge_assembly(World& world, Scratch& scratch, std::uint64_t work_cap);

/// The verdicts of one pair with its way out, and what that meets first.
PairVerdicts tell_pair(const World& world, PartId a, PartId b, std::uint64_t work_cap,
                       Scratch& scratch);

/// Which kinds the parts of a pair are, and how the second stands to the first, in steps of a
/// nanometre over the part: equal for pairs that are alike.
using PairStanding = std::array<long long, 9>;
PairStanding standing_of(const Part& a, const Part& b);

}  // namespace mortise
