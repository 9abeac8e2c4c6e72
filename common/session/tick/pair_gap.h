#pragma once
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "common/ccd/ccd_scratch.h"
#include "common/session/world/world.h"

namespace mortise {

/// How far two parts are apart as they stand.
struct PairGap {
  double mesh_mm = 0.0;  ///< of the meshes; 0 where they cross
  /// Of the real surfaces, with deviation and tolerances; below 0: they overlap by so much.
  Interval real_mm;
  bool has_verdict = false;  ///< real_mm is what the verdicts of the pair say
};

/// The gap of two parts with the bands of their rule, or their own. Of a pair with a verdict it is
/// [fake_below - delta.hi, real_above - delta.lo], the least of its regions. Else implies: no
/// admissible real surfaces are nearer than real_mm.lo, and all have points that are no farther
/// apart than real_mm.hi (see README, section 8). `work_cap`: of each of up to ten overlaps, mostly
/// three, see OverlapQuery; beyond it the interval is wider.
PairGap pair_gap(const Part& a, const Part& b, const PairRule* rule, std::uint64_t work_cap,
                 CcdScratch& scratch);

/// A pair that is nearer than asked.
struct NearPair {
  PartId a, b;
  Interval gap_mm;  ///< of the real surfaces
  double required_mm = 0.0;
};

struct NearQuery {
  double required_mm = 0.0;  ///< of pairs without one of their own; 0: none
  std::map<std::pair<PartId, PartId>, double> of_pairs_mm;
  std::set<std::pair<PartId, PartId>> left_out;  ///< pairs that met, a < b
  std::uint64_t work_cap = 3'000;                ///< see pair_gap
};

/// Pairs nearer than they must be, the nearest first.
std::vector<NearPair> near_pairs(const World& world, const NearQuery& query);

}  // namespace mortise
