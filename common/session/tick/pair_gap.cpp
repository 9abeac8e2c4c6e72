#include "common/session/tick/pair_gap.h"

#include <algorithm>
#include <cmath>

#include "common/ccd/distance.h"
#include "common/evaluation/band.h"
#include "common/geometry/plane_faces.h"
#include "common/session/tick/judgement.h"

namespace mortise {
namespace {

// How far both parts together are grown at most. Chosen: beyond it the facets of a machine part say
// as much as its surfaces, and grown corners, which stay sharp, say less.
constexpr double kMostGrown_mm = 1.0;

// How far parts are pushed into each other beyond what their bands allow, so that a place is
// certain: more than rounding, less than any size that is told.
constexpr double kPushed_mm = 1e-3;

// The last push, in offsets of the faces. A corner of three square faces travels by 1.7 of them,
// one of 15 degrees by 7.7.
constexpr double kMostPushed = 8.0;

// Meshes that are nearer touch, and have no direction in which they are apart.
constexpr double kApart_mm = 1e-9;

// Least outward offset of a band: how far inside of the mesh the real surface may be.
double inward_mm(const SurfaceBand& band) {
  double least = 0.0;
  for (const SurfaceBand::Face& face : band.faces)
    least = std::min(least, face.deviation_mm.lo + face.tolerance_mm.lo);
  return -least;
}

/// Two parts that are apart.
class ApartPair {
 public:
  ApartPair(const JudgementQuery& query, const DistanceResult& found, CcdScratch& scratch)
      : query_(query),
        a_(band_a_of(query)),
        b_(band_b_of(query)),
        found_(found),
        scratch_(scratch) {}

  Interval gap_mm() {
    Interval gap = by_offsets();
    gap.hi = std::min(gap.hi, when_pushed());
    gap.lo = std::min(std::max(gap.lo, when_grown()), gap.hi);
    return gap;
  }

 private:
  double outward_mm() const { return a_.farthest_mm() + b_.farthest_mm(); }
  double inward_both_mm() const { return inward_mm(a_) + inward_mm(b_); }

  // 1. By the offsets of all faces, wherever they are; edges may travel farther than faces.
  Interval by_offsets() const {
    return {found_.distance_mm - outward_mm(),
            found_.distance_mm + PlaneFaces::kMostTravel * inward_both_mm()};
  }

  OverlapQuery overlap() const {
    OverlapQuery overlap;
    overlap.a = query_.a->solid.get();
    overlap.b = query_.b->solid.get();
    overlap.band_a = &a_;
    overlap.band_b = &b_;
    overlap.X_WA = query_.motion_a.X_W1;
    overlap.X_WB = query_.motion_b.X_W1;
    overlap.refinement = Refinement::kFull;
    overlap.want_delta = false;
    overlap.work_cap = query_.work_cap;
    return overlap;
  }

  // 2. A part that is pushed by s and then certainly overlaps by c was no farther away than s - c.
  // Faces do at the first push, edges and corners, which travel farther, at a later one, and edges
  // in one plane, which slide past each other, once they are pushed out of it.
  double when_pushed() {
    if (!(found_.distance_mm > kApart_mm)) return kInfinity;
    const Part &a = *query_.a, &b = *query_.b;
    const Vec3 nearest = (found_.point_a_W - found_.point_b_W) / found_.distance_mm;
    const Vec3 middle =
        (a.X_WP * a.solid->sphere().center_mm - b.X_WP * b.solid->sphere().center_mm).normalized();
    for (const double aside : {0.0, 1.0})
      for (double times = 1.0; times <= kMostPushed; times *= 2.0) {
        const double more_mm = times * inward_both_mm() + kPushed_mm;
        const double most_mm =
            when_pushed_by((found_.distance_mm + more_mm) * nearest + aside * more_mm * middle);
        if (most_mm < kInfinity) return most_mm;
      }
    return kInfinity;
  }

  double when_pushed_by(const Vec3& shift_mm) {
    OverlapQuery pushed = overlap();
    pushed.X_WB.p += shift_mm;
    double most_mm = kInfinity;
    for (const OverlapRegion& region : find_overlap(pushed, scratch_).regions)
      if (region.has_witness && region.certain_mm.lo > 0.0)
        most_mm = std::min(most_mm, shift_mm.norm() - region.certain_mm.lo);
    return most_mm;
  }

  // 3. Parts that are grown by g in all and then overlap by p at most were apart by g - p at least.
  double when_grown() {
    const double g_mm = found_.distance_mm + outward_mm() + kPushed_mm;
    if (g_mm > kMostGrown_mm) return -kInfinity;
    const SurfaceBand a = grown(a_, *query_.a->solid, 0.5 * g_mm);
    const SurfaceBand b = grown(b_, *query_.b->solid, 0.5 * g_mm);
    OverlapQuery larger = overlap();
    larger.band_a = &a;
    larger.band_b = &b;
    const OverlapResult found = find_overlap(larger, scratch_);
    if (found.no_inside || found.regions.empty()) return -kInfinity;
    double most_mm = -kInfinity;
    for (const OverlapRegion& region : found.regions)
      most_mm = std::max(most_mm, region.possible_mm.hi);
    return g_mm - most_mm;
  }

  const JudgementQuery& query_;
  const SurfaceBand &a_, &b_;
  const DistanceResult& found_;
  CcdScratch& scratch_;
};

// The least of the regions, each as its verdict tells it.
Interval judged_mm(const std::vector<Verdict>& verdicts) {
  Interval gap{kInfinity, kInfinity};
  for (const Verdict& v : verdicts) {
    gap.lo = std::min(gap.lo, v.fake_below_mm - v.delta_mm.hi);
    gap.hi = std::min(gap.hi, v.real_above_mm - v.delta_mm.lo);
  }
  return gap;
}

}  // namespace

PairGap pair_gap(const Part& a, const Part& b, const PairRule* rule, std::uint64_t work_cap,
                 CcdScratch& scratch) {
  JudgementQuery query;
  query.a = &a;
  query.b = &b;
  query.rule = rule;
  query.motion_a = still_motion(a.X_WP);
  query.motion_b = still_motion(b.X_WP);
  query.want_gpd = false;
  query.work_cap = work_cap;
  PairGap gap;
  const DistanceResult found = distance(*a.solid, a.X_WP, *b.solid, b.X_WP, scratch);
  gap.mesh_mm = found.distance_mm;
  const Judgement judged = judge_pair(query, scratch);
  gap.has_verdict = !judged.verdicts.empty();
  gap.real_mm =
      gap.has_verdict ? judged_mm(judged.verdicts) : ApartPair(query, found, scratch).gap_mm();
  return gap;
}

std::vector<NearPair> near_pairs(const World& world, const NearQuery& query) {
  std::vector<Box> boxes(world.parts.size());
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (const Vec3& x : world.parts[i].solid->mesh().points_mm)
      boxes[i].add(world.parts[i].X_WP * x);
  std::vector<NearPair> near;
  CcdScratch scratch;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t j = i + 1; j < boxes.size(); ++j) {
      const Part &a = world.parts[i], &b = world.parts[j];
      if (!a.present || !b.present) continue;
      const auto own = query.of_pairs_mm.find({a.id, b.id});
      const double required_mm = own == query.of_pairs_mm.end() ? query.required_mm : own->second;
      if (!(required_mm > 0.0) || query.left_out.contains({a.id, b.id})) continue;
      const PairRule* rule = world.rule(a.id, b.id);
      const SurfaceBand& band_a = rule != nullptr && rule->band_a ? *rule->band_a : a.band;
      const SurfaceBand& band_b = rule != nullptr && rule->band_b ? *rule->band_b : b.band;
      const double reach_mm = required_mm + band_a.farthest_mm() + band_b.farthest_mm();
      if (!boxes[i].grown(reach_mm).overlaps(boxes[j]) ||
          !distance(*a.solid, a.X_WP, *b.solid, b.X_WP, scratch, reach_mm).within_limit)
        continue;
      const Interval gap_mm = pair_gap(a, b, rule, query.work_cap, scratch).real_mm;
      if (gap_mm.lo < required_mm) near.push_back({a.id, b.id, gap_mm, required_mm});
    }
  std::sort(near.begin(), near.end(),
            [](const NearPair& x, const NearPair& y) { return x.gap_mm.lo < y.gap_mm.lo; });
  return near;
}

}  // namespace mortise
