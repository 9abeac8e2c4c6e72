#include "tests/bench/judgement_ask.h"

#include <algorithm>

#include "tests/bench/statistics.h"

namespace mortise::bench {

Part part_of(std::uint32_t id, const JudgedPart& judged, SurfaceBand band) {
  Part part;
  part.id = PartId{id};
  part.name = id == 1 ? "inner" : "outer";
  part.solid = judged.solid;
  part.band = std::move(band);
  part.features = judged.features;
  return part;
}

Word ask_ours(const KnownPair& pair, const Pose& X_WA, const Pose& X_WB, const AskOurs& how) {
  JudgementQuery query;
  query.a = how.swapped ? &pair.b : &pair.a;
  query.b = how.swapped ? &pair.a : &pair.b;
  query.motion_a = still_motion(how.swapped ? X_WB : X_WA);
  query.motion_b = still_motion(how.swapped ? X_WA : X_WB);
  query.refinement = how.refinement;
  query.want_gpd = false;
  query.work_cap = how.work_cap;
  // Trees and topologies belong to the part, not to the question.
  for (const Part* part : {query.a, query.b}) part->solid->bvh(), part->solid->topology();
  CcdScratch scratch;
  const Stopwatch watch;
  const Judgement judgement = judge_pair(query, scratch);
  Word word;
  word.time_s = watch.elapsed_s();
  if (!judgement.verdicts.empty()) {
    const Verdict& worst = judgement.verdicts[0];
    word.collision_class = worst.collision_class;
    if (worst.has_witness) word.witness_W = worst.witness_W;
  }
  for (const OverlapRegion& region : judgement.overlap.regions) {
    const auto deeper = [](std::optional<Interval>& worst, const Interval& found) {
      worst =
          worst ? Interval{std::max(worst->lo, found.lo), std::max(worst->hi, found.hi)} : found;
    };
    deeper(word.depth_mm, region.delta_mm);
    deeper(word.certain_mm, region.certain_mm);
    deeper(word.possible_mm, region.possible_mm);
    word.capped |= region.capped;
  }
  return word;
}

}  // namespace mortise::bench
