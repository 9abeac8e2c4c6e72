#include "common/session/tick/judge_world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "common/broadphase/pair_filter.h"
#include "common/ccd/distance.h"
#include "common/ccd/start_state.h"
#include "common/evaluation/clash_line.h"
#include "common/session/tick/statistics.h"
#include "common/session/tick/tick_work.h"
#include "common/session/tick/way_out.h"

namespace mortise {
namespace {

struct Judged {
  PairVerdicts verdicts;
  StepCounters counts;
};

// How closely a world is judged.
struct Closeness {
  Refinement refinement = Refinement::kDecided;
  std::uint64_t work_cap = JudgementQuery().work_cap;
  bool alike_once = false, want_gpd = true;
};

Judged judge_one(const Part& a, const Part& b, const PairRule* rule, const Closeness& closeness,
                 CcdScratch& ccd) {
  Judged judged;
  JudgementQuery query;
  query.a = &a;
  query.b = &b;
  query.rule = rule;
  query.motion_a = still_motion(a.X_WP);
  query.motion_b = still_motion(b.X_WP);
  query.refinement = closeness.refinement;
  query.work_cap = closeness.work_cap;
  query.want_gpd = closeness.want_gpd;
  Judgement judgement = judge_pair(query, ccd);
  // Little work looks at some points only for whether nothing but the meshes overlaps.
  const std::uint64_t whole_work = JudgementQuery().work_cap;
  if (judgement.verdicts.empty() && query.work_cap < whole_work &&
      !(band_a_of(query).trivial && band_b_of(query).trivial) &&
      surfaces_cross(*a.solid, a.X_WP, *b.solid, b.X_WP, ccd)) {
    query.work_cap = whole_work;
    judgement = judge_pair(query, ccd);
  }
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
  if (closeness.refinement == Refinement::kFull && !judgement.verdicts.empty())
    judged.verdicts.layers = depths_of_layers(query, judgement, ccd);
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
      continue;
    }
    verdict.separation_way = looked->separation_way;
    verdict.separation_translation_mm = looked->separation_translation_mm;
    verdict.separation_rotation_rad = looked->separation_rotation_rad;
    verdict.separation_path = looked->separation_path;
    verdict.separation_blocker = looked->separation_blocker;
  }
}

// The candidate that stands for each: itself, or an earlier one that it is like.
std::vector<std::size_t> leaders_of(const World& world, const std::vector<IndexPair>& candidates,
                                    bool alike_once) {
  std::vector<std::size_t> leaders(candidates.size());
  std::map<PairStanding, std::size_t> known;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Part &a = world.parts[candidates[i].a], &b = world.parts[candidates[i].b];
    leaders[i] = i;
    if (alike_once && world.rule(a.id, b.id) == nullptr)
      leaders[i] = known.try_emplace(standing_of(a, b), i).first->second;
  }
  return leaders;
}

void rename(std::string& text, const std::string& from, const std::string& to) {
  if (const std::size_t at = text.find(from); at != std::string::npos && !from.empty())
    text.replace(at, from.size(), to);
}

// The verdicts of a pair that is like another one, where it stands.
PairVerdicts moved(const PairVerdicts& of, const World& world, const Part& a, const Part& b) {
  const Part& from = *world.find(of.a);
  PairVerdicts at = of;
  at.a = a.id;
  at.b = b.id;
  at.like_a = of.a;
  at.like_b = of.b;
  const Pose X = a.X_WP * from.X_WP.inverse();
  for (Verdict& v : at.verdicts) {
    v.point_W = X * v.point_W;
    v.normal_W = X.q * v.normal_W;
    v.witness_W = X * v.witness_W;
    v.separation_about_W = X * v.separation_about_W;
    v.separation_translation_mm = X.q * v.separation_translation_mm;
    v.separation_rotation_rad = X.q * v.separation_rotation_rad;
    if (v.explanation.find(kWhollyInside) == std::string::npos) continue;
    rename(v.explanation, from.name, a.name);
    rename(v.explanation, world.find(of.b)->name, b.name);
  }
  return at;
}

// Unlike a tick, static pairs are judged as well: this is a question about the scene, not about a
// change.
std::vector<IndexPair> candidates_of(World& world, Scratch::Impl& work, JudgeReport& report) {
  SessionState& state = session_state(world, work.switches.brute_force_pairs);
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
  return candidates;
}

std::vector<Judged> judge_all(const World& world, Scratch::Impl& work,
                              const std::vector<IndexPair>& candidates,
                              const Closeness& closeness) {
  const std::vector<std::size_t> leaders = leaders_of(world, candidates, closeness.alike_once);
  std::vector<Judged> judged(candidates.size());
  work.pool.for_each(candidates.size(), [&](std::size_t i, int thread) {
    if (leaders[i] != i) return;
    const Part& a = world.parts[candidates[i].a];
    const Part& b = world.parts[candidates[i].b];
    judged[i] = judge_one(a, b, world.rule(a.id, b.id), closeness,
                          work.ccd[static_cast<std::size_t>(thread)]);
  });

  for (std::size_t i = 0; i < judged.size(); ++i)
    if (leaders[i] != i) {
      const Judged& of = judged[leaders[i]];
      judged[i].counts = of.counts;
      judged[i].verdicts =
          moved(of.verdicts, world, world.parts[candidates[i].a], world.parts[candidates[i].b]);
    }
  if (!closeness.want_gpd) return judged;
  // Somebody looks at what is told here: what stands in the way is told as well.
  work.pool.for_each(judged.size(), [&](std::size_t i, int thread) {
    look_along_ways(world, judged[i].verdicts, work.ccd[static_cast<std::size_t>(thread)]);
  });
  return judged;
}

AssemblyJudgement judge(World& world, Scratch& scratch, const Closeness& closeness) {
  AssemblyJudgement judgement;
  JudgeReport& report = judgement.report;
  const auto n = static_cast<std::uint32_t>(world.parts.size());
  const std::vector<IndexPair> candidates = candidates_of(world, scratch.impl(), report);
  std::vector<Judged> judged = judge_all(world, scratch.impl(), candidates, closeness);
  StepCounters& counters = report.counters;
  std::vector<char> without_inside(n, 0);
  for (std::size_t i = 0; i < judged.size(); ++i) {
    accumulate(counters, judged[i].counts);
    if (judged[i].verdicts.no_inside)
      for (const std::uint32_t part : {candidates[i].a, candidates[i].b})
        if (!world.parts[part].solid->has_inside()) without_inside[part] = 1;
    if (!judged[i].verdicts.verdicts.empty() || judged[i].verdicts.not_examined)
      report.pairs.push_back(std::move(judged[i].verdicts));
    else
      judgement.without_verdict.push_back(candidates[i]);
  }
  for (const auto& [pair, rule] : world.pair_rules)
    counters.pairs_excluded +=
        rule.excluded && world.find_present(pair.first) && world.find_present(pair.second);
  std::sort(report.pairs.begin(), report.pairs.end(),
            [](const PairVerdicts& x, const PairVerdicts& y) {
              return std::pair(x.a, x.b) < std::pair(y.a, y.b);
            });
  counters.parts_without_inside =
      static_cast<std::uint64_t>(std::count(without_inside.begin(), without_inside.end(), 1));
  const std::uint64_t present = world.state->present_parts;
  counters.pairs = {count_pairs(present, present, present).all, candidates.size()};
  counters.pairs_boxes_apart = counters.pairs.in - counters.pairs.out - counters.pairs_excluded;
  return judgement;
}

}  // namespace

PairStanding standing_of(const Part& a, const Part& b) {
  // Standings that agree to the distance at which meshes count as touching are the same.
  constexpr double kStep_mm = 1e-6;
  const Pose X_AB = a.X_WP.inverse() * b.X_WP;
  const double reach_mm = std::max(1.0, b.solid->sphere().radius_mm);
  PairStanding key{a.kind, b.kind};
  const double sign = X_AB.q.w() < 0.0 ? -1.0 : 1.0;
  for (int i = 0; i < 3; ++i) {
    key[static_cast<std::size_t>(2 + i)] = std::llround(X_AB.p[i] / kStep_mm);
    key[static_cast<std::size_t>(5 + i)] =
        std::llround(sign * X_AB.q.vec()[i] * reach_mm / kStep_mm);
  }
  key[8] = std::llround(sign * X_AB.q.w() * reach_mm / kStep_mm);
  return key;
}

JudgeReport judge_world(World& world, Scratch& scratch, bool full_brackets) {
  Closeness closeness;
  if (full_brackets) closeness.refinement = Refinement::kFull;
  return judge(world, scratch, closeness).report;
}

PairVerdicts tell_pair(const World& world, PartId a, PartId b, std::uint64_t work_cap,
                       Scratch& scratch) {
  CcdScratch& ccd = scratch.impl().ccd.front();
  PairVerdicts told = judge_one(*world.find(a), *world.find(b), world.rule(a, b),
                                {Refinement::kDecided, work_cap}, ccd)
                          .verdicts;
  look_along_ways(world, told, ccd);
  return told;
}

AssemblyJudgement judge_assembly(World& world, Scratch& scratch, std::uint64_t work_cap) {
  return judge(world, scratch, {Refinement::kDecided, work_cap, true, false});
}

}  // namespace mortise
