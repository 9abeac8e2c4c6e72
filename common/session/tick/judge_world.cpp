#include "common/session/tick/judge_world.h"

#include <algorithm>

#include "common/broadphase/pair_filter.h"
#include "common/ccd/distance.h"
#include "common/ccd/start_state.h"
#include "common/session/tick/statistics.h"
#include "common/session/tick/tick_work.h"
#include "common/session/tick/way_out.h"

namespace mortise {
namespace {

struct Judged {
  PairVerdicts verdicts;
  StepCounters counts;
};

Judged judge_one(const Part& a, const Part& b, const PairRule* rule, bool full_brackets,
                 CcdScratch& ccd) {
  Judged judged;
  JudgementQuery query;
  query.a = &a;
  query.b = &b;
  query.rule = rule;
  query.motion_a = still_motion(a.X_WP);
  query.motion_b = still_motion(b.X_WP);
  query.refinement = full_brackets ? Refinement::kFull : Refinement::kDecided;
  Judgement judgement = judge_pair(query, ccd);
  StepCounters& counts = judged.counts;
  count(query, judgement, counts);
  counts.contacts.in = 1;
  const bool near = !judgement.overlap.regions.empty() || judgement.overlap.meshes_cross ||
                    judgement.overlap.contained;
  ++(near ? counts.contacts.out : counts.contacts_clear);
  for (const OverlapRegion& region : judgement.overlap.regions)
    if (region.capped) counts.not_examined = 1;
  judged.verdicts.a = a.id;
  judged.verdicts.b = b.id;
  judged.verdicts.no_inside = judgement.overlap.no_inside;
  judged.verdicts.verdicts = std::move(judgement.verdicts);
  if (judged.verdicts.verdicts.empty() &&
      containment(*a.solid, a.X_WP, *b.solid, b.X_WP, kAccuracyDefault_mm) ==
          Containment::kUnknown) {
    judged.verdicts.not_examined = true;
    counts.not_examined = 1;
  }
  if (!judged.verdicts.verdicts.empty() && !judgement.overlap.meshes_cross &&
      !judgement.overlap.contained) {
    counts.distance_queries = 1;
    judged.verdicts.distance_mm = distance(*a.solid, a.X_WP, *b.solid, b.X_WP, ccd).distance_mm;
  }
  return judged;
}

// All regions of a pair have one way out, but for those of which only the zones meet.
void look_along_ways(const World& world, PairVerdicts& pair, CcdScratch& ccd) {
  double depth_mm = 0.0;
  for (const Verdict& verdict : pair.verdicts) depth_mm = std::max(depth_mm, verdict.delta_mm.hi);
  const Verdict* looked = nullptr;
  for (Verdict& verdict : pair.verdicts) {
    if (verdict.separation_way == SeparationWay::kNone) continue;
    if (looked == nullptr) {
      look_along_way(world, pair.a, pair.b, depth_mm, verdict, ccd);
      looked = &verdict;
    }
    verdict.separation_path = looked->separation_path;
    verdict.separation_blocker = looked->separation_blocker;
  }
}

}  // namespace

// Unlike a tick, static pairs are judged as well: this is a question about the scene, not about a
// change.
JudgeReport judge_world(World& world, Scratch& scratch, bool full_brackets) {
  Scratch::Impl& work = scratch.impl();
  SessionState& state = session_state(world, work.switches.brute_force_pairs);
  JudgeReport report;
  const std::uint32_t n = static_cast<std::uint32_t>(world.parts.size());
  std::vector<std::uint32_t> all(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    all[i] = i;
    state.broad_phase->set_box(i, resting_box(world, state, i));
  }
  std::vector<IndexPair> candidates;
  state.broad_phase->find_pairs(all, candidates);
  std::erase_if(candidates, [&](IndexPair pair) {
    const PartId a = world.parts[pair.a].id, b = world.parts[pair.b].id;
    const PairRule* rule = world.rule(a, b);
    if (rule == nullptr || !rule->excluded) return false;
    PairVerdicts excluded;  // listed, for it is near
    excluded.a = std::min(a, b);
    excluded.b = std::max(a, b);
    excluded.excluded = true;
    report.pairs.push_back(std::move(excluded));
    return true;
  });

  std::vector<Judged> judged(candidates.size());
  work.pool.for_each(candidates.size(), [&](std::size_t i, int thread) {
    const Part& a = world.parts[candidates[i].a];
    const Part& b = world.parts[candidates[i].b];
    judged[i] = judge_one(a, b, world.rule(a.id, b.id), full_brackets,
                          work.ccd[static_cast<std::size_t>(thread)]);
  });

  // Somebody looks at what is told here: what stands in the way is told as well.
  work.pool.for_each(judged.size(), [&](std::size_t i, int thread) {
    look_along_ways(world, judged[i].verdicts, work.ccd[static_cast<std::size_t>(thread)]);
  });

  StepCounters& counters = report.counters;
  std::vector<char> without_inside(n, 0);
  for (std::size_t i = 0; i < judged.size(); ++i) {
    accumulate(counters, judged[i].counts);
    if (judged[i].verdicts.no_inside)
      for (const std::uint32_t part : {candidates[i].a, candidates[i].b})
        if (!world.parts[part].solid->has_inside()) without_inside[part] = 1;
    if (!judged[i].verdicts.verdicts.empty() || judged[i].verdicts.not_examined)
      report.pairs.push_back(std::move(judged[i].verdicts));
  }
  for (const auto& [pair, rule] : world.pair_rules) counters.pairs_excluded += rule.excluded;
  std::sort(report.pairs.begin(), report.pairs.end(),
            [](const PairVerdicts& x, const PairVerdicts& y) {
              return std::pair(x.a, x.b) < std::pair(y.a, y.b);
            });
  counters.parts_without_inside =
      static_cast<std::uint64_t>(std::count(without_inside.begin(), without_inside.end(), 1));
  counters.pairs = {count_pairs(n, n, n).all, candidates.size()};
  counters.pairs_boxes_apart = counters.pairs.in - counters.pairs.out - counters.pairs_excluded;
  return report;
}

}  // namespace mortise
