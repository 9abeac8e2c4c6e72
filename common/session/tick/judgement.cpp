#include "common/session/tick/judgement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/base/constants.h"
#include "common/evaluation/clash_line.h"
#include "common/evaluation/explain.h"
#include "common/evaluation/interference.h"
#include "common/evaluation/open_bracket.h"
#include "common/messages/length_text.h"
#include "common/session/tick/merge_regions.h"

namespace mortise {
namespace {

// A margin that nothing bounds is not a number that the wire can carry.
double finite_or_zero(double x) { return std::isfinite(x) ? x : 0.0; }

// What a longer search for the generalized depth may cost, as a multiple of the lazy one.
constexpr std::uint64_t kFullDepthWork = 10;
// Of the same part twice one is deleted, not taken out by the shortest way: so much less work will
// do. It told the same depths of all parts in the benchmark's one place.
constexpr std::uint64_t kLessForDuplicates = 8;

DeviationGrade worst_of(DeviationGrade a, DeviationGrade b) { return std::max(a, b); }

// Distance of the overlap to the nearest threshold that would change the class.
double margin_of(CollisionClass collision_class, const Interval& delta_mm, const Thresholds& t) {
  switch (collision_class) {
    case CollisionClass::kReal:
      return std::max(0.0, delta_mm.lo - t.real_above_mm);
    case CollisionClass::kFake:
      return std::max(0.0, t.fake_below_mm - delta_mm.hi);
    case CollisionClass::kPotential:
      return std::max(0.0, std::min(delta_mm.lo - t.fake_below_mm, t.real_above_mm - delta_mm.hi));
    case CollisionClass::kNone:
      break;
  }
  return 0.0;
}

struct Faces {
  const SurfaceBand::Face& a;
  const SurfaceBand::Face& b;
};

OverlapQuery overlap_query(const JudgementQuery& query) {
  OverlapQuery overlap;
  overlap.a = query.a->solid.get();
  overlap.b = query.b->solid.get();
  overlap.band_a = &band_a_of(query);
  overlap.band_b = &band_b_of(query);
  overlap.X_WA = query.motion_a.X_W1;
  overlap.X_WB = query.motion_b.X_W1;
  overlap.refinement = query.refinement;
  overlap.work_cap = query.work_cap;
  return overlap;
}

bool surfaces_known(const OverlapRegion& region, const Faces& faces, const Verdict& verdict) {
  return !region.at_crack && !region.estimated && region.witnesses_refused == 0 &&
         verdict.grade != DeviationGrade::kDeclaredChord &&
         verdict.grade != DeviationGrade::kEstimated && is_surface_known(faces.a, region.shape_a) &&
         is_surface_known(faces.b, region.shape_b);
}

std::optional<Interval> probability_of(const JudgementQuery& query, const OverlapRegion& region,
                                       bool no_inside, const Faces& faces, const Verdict& verdict) {
  if (no_inside || !surfaces_known(region, faces, verdict)) return std::nullopt;
  InterferenceZones zones{region.certain_mm,
                          region.possible_mm,
                          faces.a.size_mm(),
                          faces.b.size_mm(),
                          faces.a.position_mm,
                          faces.b.position_mm,
                          {}};
  const double length_mm =
      2.0 * std::min(query.a->solid->sphere().radius_mm, query.b->solid->sphere().radius_mm);
  if (zones.position_a_mm + zones.position_b_mm > 0.0)
    zones.axes = parallel_axes(
        {&faces.a, &faces.b, query.motion_a.X_W1, query.motion_b.X_W1, region.point_W, length_mm});
  return interference_probability(zones);
}

void explain_verdict(const JudgementQuery& query, const OverlapRegion& region, bool no_inside,
                     const Faces& faces, const std::optional<Interval>& probability,
                     Verdict& verdict) {
  ExplainInput input;
  input.collision_class = verdict.collision_class;
  input.delta_mm = region.delta_mm;
  input.thresholds = {verdict.fake_below_mm, verdict.real_above_mm};
  input.margin_mm = verdict.margin_mm;
  input.face_a = &faces.a;
  input.face_b = &faces.b;
  input.tolerance_mm = faces.a.tolerance_mm + faces.b.tolerance_mm;
  input.grade = verdict.grade;
  input.probability = probability;
  input.no_inside = no_inside;
  input.at_crack = region.at_crack;
  input.capped = region.capped;
  input.estimated = region.estimated;
  input.witnesses_refused = region.witnesses_refused;
  // A threshold is as uncertain as the bracket of the overlap with offsets that it is made of.
  input.fake_known = !is_open(region.possible_mm);
  input.real_known = !is_open(region.certain_mm);
  if (query.rule != nullptr) input.fit = query.rule->fit;
  verdict.explanation = explain(input);
}

Verdict judge_region(const JudgementQuery& query, const OverlapRegion& region, bool no_inside) {
  const Faces faces{band_a_of(query).face_of(region.deciding_triangle_a),
                    band_b_of(query).face_of(region.deciding_triangle_b)};
  Verdict verdict;
  verdict.collision_class = classify({region.delta_mm, region.certain_mm, region.possible_mm,
                                      region.has_witness, no_inside || region.at_crack});
  verdict.delta_mm = region.delta_mm;
  const Thresholds thresholds =
      thresholds_of(region.delta_mm, region.certain_mm, region.possible_mm);
  verdict.fake_below_mm = thresholds.fake_below_mm;
  verdict.real_above_mm = thresholds.real_above_mm;
  verdict.margin_mm =
      finite_or_zero(margin_of(verdict.collision_class, region.delta_mm, thresholds));
  if (verdict.collision_class == CollisionClass::kReal) verdict.probability = 1.0;
  verdict.point_W = region.point_W;
  verdict.normal_W = region.normal_W;
  verdict.area_mm2 = region.area_mm2;
  verdict.has_witness = region.has_witness;
  verdict.witness_W = region.witness_W;
  verdict.shape_a = region.shape_a;
  verdict.shape_b = region.shape_b;
  verdict.grade = worst_of(worst_of(faces.a.grade, faces.b.grade), region.grade);
  if (region.estimated) verdict.grade = worst_of(verdict.grade, DeviationGrade::kEstimated);
  verdict.face_a = faces.a.name;
  verdict.face_b = faces.b.name;
  std::optional<Interval> probability;
  if (verdict.collision_class == CollisionClass::kPotential) {
    probability = probability_of(query, region, no_inside, faces, verdict);
    verdict.probability = probability ? probability->middle() : kProbabilityUnknown;
  }
  explain_verdict(query, region, no_inside, faces, probability, verdict);
  return verdict;
}

// The part that is moved out is the one that moves; else one that is held; else one that may move.
bool b_is_moved(const JudgementQuery& query) {
  const auto rank = [](const Motion& motion, const Part& part) {
    return motion.moves() ? 3 : part.holder ? 2 : part.moving ? 1 : 0;
  };
  return rank(query.motion_b, *query.b) > rank(query.motion_a, *query.a);
}

OverlapResult overlap_of(const OverlapQuery& overlap, CcdScratch& scratch) {
  OverlapResult result = find_overlap(overlap, scratch);
  result.regions = merge_regions(result.regions, *overlap.band_a, *overlap.band_b);
  return result;
}

// Of the pair: one motion has to free all its regions.
GeneralizedDepth depth_of_pair(const JudgementQuery& query, const OverlapQuery& overlap,
                               std::span<const OverlapRegion> regions, CcdScratch& scratch,
                               std::uint64_t& evaluations) {
  GpdQuery gpd;
  gpd.overlap = overlap;
  gpd.regions = regions;
  gpd.b_moves = b_is_moved(query);
  gpd.motion_a = query.motion_a;
  gpd.motion_b = query.motion_b;
  gpd.t_contact = query.t_contact;
  const auto left = [&] { return query.whole_cap - std::min(query.whole_cap, evaluations); };
  const std::uint64_t full_cap = kFullDepthWork * gpd.work_cap;
  if (are_duplicates(*overlap.a, overlap.X_WA, *overlap.b, overlap.X_WB))
    gpd.work_cap /= kLessForDuplicates;
  gpd.work_cap = std::min(gpd.work_cap, left());
  if (overlap.refinement != Refinement::kFull) {
    const GeneralizedDepth depth = generalized_depth(gpd, scratch);
    evaluations += depth.evaluations;
    return depth;
  }
  // In full: begins where the lazy search ends, so that it is never the worse.
  GpdQuery lazy = gpd;
  lazy.overlap.refinement = Refinement::kDecided;
  lazy.overlap.work_cap = std::min(lazy.overlap.work_cap, left());
  const OverlapResult decided = overlap_of(lazy.overlap, scratch);
  lazy.regions = decided.regions;
  const GeneralizedDepth first = generalized_depth(lazy, scratch);
  evaluations += decided.evaluations + first.evaluations;
  gpd.work_cap = std::min(full_cap, left());
  if (first.motion.moves()) gpd.known = &first.motion;
  GeneralizedDepth depth = generalized_depth(gpd, scratch);
  evaluations += depth.evaluations;
  depth.gpd_mm.lo = std::max(depth.gpd_mm.lo, std::min(first.gpd_mm.lo, depth.gpd_mm.hi));
  return depth;
}

void tell_depth(const JudgementQuery& query, const GeneralizedDepth& depth,
                const OverlapRegion& region, Verdict& verdict) {
  const TravelSinceContact travel =
      travel_since_contact(region, query.motion_a, query.motion_b, query.t_contact);
  verdict.travel_mm = travel.path_mm;
  verdict.normal_travel_mm = travel.normal_mm;
  if (region.delta_mm.hi <= 0.0) return;  // only its zones meet: nothing to do
  verdict.gpd_mm = depth.gpd_mm;
  verdict.separation_translation_mm = depth.motion.translation_mm;
  verdict.separation_rotation_rad = depth.motion.rotation_rad;
  verdict.separation_about_W = depth.motion.about_W;
  verdict.separation_of_b = depth.motion.of_b;
  verdict.separation_way = depth.way;
}

// Fake ones need no way out, and without an inside there is no depth.
bool wants_depth(const Judgement& judgement, const OverlapRegion& region, const Verdict& verdict) {
  return verdict.collision_class != CollisionClass::kFake && !judgement.overlap.no_inside &&
         !region.at_crack;
}

// "the same part twice in one place", "pin lies wholly inside block", or nothing.
std::string placement_text(const JudgementQuery& query, const OverlapResult& overlap) {
  const Part &a = *query.a, &b = *query.b;
  const double radius_mm = a.solid->sphere().radius_mm;
  const Pose &X_WA = query.motion_a.X_W1, &X_WB = query.motion_b.X_W1;
  if (are_duplicates(*a.solid, X_WA, *b.solid, X_WB)) {
    const double apart_mm = twins_apart_mm(*a.solid, X_WA, *b.solid, X_WB);
    return kSamePartTwice + (apart_mm <= kAccuracyDefault_mm
                                 ? " in one place"
                                 : ", " + length_text(apart_mm) + " apart");
  }
  if (!overlap.contained) return "";
  const bool a_is_inner = radius_mm < b.solid->sphere().radius_mm;
  return (a_is_inner ? a : b).name + kWhollyInside + (a_is_inner ? b : a).name;
}

// Is the depth of the region known as closely as was asked for at most, layer by layer?
bool is_refined(const OverlapRegion& region) {
  const double most = 2.0 * kDepthAccuracyDefault_mm;
  return region.delta_mm.width() <= most && region.certain_mm.width() <= most &&
         region.possible_mm.width() <= most;
}

}  // namespace

const SurfaceBand& band_a_of(const JudgementQuery& query) {
  return query.rule != nullptr && query.rule->band_a ? *query.rule->band_a : query.a->band;
}

const SurfaceBand& band_b_of(const JudgementQuery& query) {
  return query.rule != nullptr && query.rule->band_b ? *query.rule->band_b : query.b->band;
}

void add_depths(const JudgementQuery& query, Judgement& judgement, CcdScratch& scratch) {
  std::optional<GeneralizedDepth> depth;
  for (std::size_t i = 0; i < judgement.verdicts.size(); ++i) {
    Verdict& verdict = judgement.verdicts[i];
    const OverlapRegion& region = judgement.overlap.regions[judgement.of_regions[i]];
    if (!wants_depth(judgement, region, verdict)) continue;
    if (!depth)
      depth = depth_of_pair(query, overlap_query(query), judgement.overlap.regions, scratch,
                            judgement.overlap.evaluations);
    tell_depth(query, *depth, region, verdict);
  }
}

Judgement judge_pair(const JudgementQuery& query, CcdScratch& scratch) {
  Judgement judgement;
  judgement.overlap = overlap_of(overlap_query(query), scratch);
  const std::vector<OverlapRegion>& regions = judgement.overlap.regions;
  std::vector<std::pair<Verdict, std::size_t>> judged;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    Verdict verdict = judge_region(query, regions[i], judgement.overlap.no_inside);
    if (verdict.collision_class != CollisionClass::kNone)
      judged.emplace_back(std::move(verdict), i);
  }
  // Worst first; the regions are sorted by depth already.
  std::stable_sort(judged.begin(), judged.end(), [](const auto& x, const auto& y) {
    return static_cast<int>(x.first.collision_class) > static_cast<int>(y.first.collision_class);
  });
  for (auto& [verdict, region] : judged) {
    judgement.verdicts.push_back(std::move(verdict));
    judgement.of_regions.push_back(region);
  }
  if (judgement.verdicts.empty()) return judgement;
  if (query.want_gpd) add_depths(query, judgement, scratch);
  Verdict& worst = judgement.verdicts.front();
  if (const std::string text = placement_text(query, judgement.overlap);
      worst.collision_class == CollisionClass::kReal && !text.empty())
    worst.explanation += "; " + text;
  return judgement;
}

LayerDepths depths_of_layers(const JudgementQuery& query, const Judgement& judgement,
                             CcdScratch& scratch) {
  if (!query.a->solid->inside_known() || !query.b->solid->inside_known()) return {};
  if (judgement.verdicts.empty() ||
      judgement.verdicts.front().collision_class == CollisionClass::kFake)
    return {Interval{}, Interval{}};
  if (band_a_of(query).trivial && band_b_of(query).trivial) {
    const Interval& mesh = judgement.verdicts.front().gpd_mm;
    return {mesh, mesh};
  }
  GpdQuery gpd;
  gpd.overlap = overlap_query(query);
  gpd.b_moves = b_is_moved(query);
  gpd.motion_a = query.motion_a;
  gpd.motion_b = query.motion_b;
  gpd.t_contact = query.t_contact;
  LayerDepths layers = depths_of_layers(query.a->solid, query.b->solid, gpd, scratch);
  if (!layers.least_mm) return layers;
  Interval &least = *layers.least_mm, &most = *layers.largest_mm;
  for (const OverlapRegion& region : judgement.overlap.regions)
    if (region.has_witness) least.lo = std::clamp(region.certain_mm.lo, least.lo, least.hi);
  most.lo = std::clamp(least.lo, most.lo, most.hi);
  return layers;
}

void count(const JudgementQuery& query, const Judgement& judgement, StepCounters& counts) {
  ++counts.depth_queries;
  ++(band_a_of(query).trivial && band_b_of(query).trivial ? counts.judged_plain
                                                          : counts.judged_with_bands);
  counts.depth_evaluations += judgement.overlap.evaluations;
  counts.verdicts.in += judgement.overlap.regions.size();
  counts.verdicts.out += judgement.verdicts.size();
  for (const Verdict& verdict : judgement.verdicts)
    ++counts.verdicts_by_class[static_cast<std::size_t>(verdict.collision_class)];
  for (const OverlapRegion& region : judgement.overlap.regions)
    if (!region.capped)
      ++(query.refinement == Refinement::kFull || is_refined(region)
             ? counts.regions_refined
             : counts.regions_decided_early);
}

}  // namespace mortise
