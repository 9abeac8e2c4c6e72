#include "common/depth/deep_region.h"

#include <algorithm>

#include "common/depth/convex_overlap.h"

namespace mortise {
namespace {

// Evaluations, some microseconds each; where they end, the depth is told as "at least".
constexpr std::uint64_t kQuestions = 80'000, kQuestionsLazily = 800;

}  // namespace

OverlapRegion region_of(const PairFrame& pair, const SharedInside& shared) {
  OverlapRegion region;
  region.delta_mm = {shared.depth_mm, 2.0 * pair.smaller_radius_mm()};
  region.certain_mm = {shared.depth_mm - pair.reach_mm(Layer::kLower), region.delta_mm.hi};
  region.possible_mm = {shared.depth_mm - pair.reach_mm(Layer::kUpper),
                        region.delta_mm.hi + pair.reach_mm(Layer::kUpper)};
  region.point_W = region.witness_W = shared.point_W;
  region.has_witness = region.certain_mm.lo > 0.0;
  region.triangle_a = region.deciding_triangle_a = shared.triangle[0];
  region.triangle_b = region.deciding_triangle_b = shared.triangle[1];
  region.normal_W = -(pair.X_W[0].q * pair.bodies[0].normal(region.triangle_a));
  set_shapes(pair, region);
  region.points_W = {region.point_W};
  return region;
}

void tell_inner_overlap(const PairFrame& pair, const OverlapQuery& query, bool layers_known,
                        OverlapRegion& region, std::uint64_t& evaluations) {
  if (region.at_crack || region.delta_mm.lo < -pair.touch_mm) return;  // not known, or apart
  const bool full = query.refinement == Refinement::kFull;
  InnerStart start;
  const Vec3 deepest[] = {region.point_W};
  start.points_W = full ? std::span<const Vec3>(region.points_W) : std::span<const Vec3>(deepest);
  start.depth_mm = std::max(0.0, region.delta_mm.lo);
  start.everywhere = full;
  start.accuracy_mm = query.accuracy_mm;
  const std::uint64_t left = query.work_cap - std::min(query.work_cap, evaluations);
  auto inner = convex_overlap(pair, region.point_W, query.accuracy_mm, evaluations);
  if (!inner)
    inner = find_inner_overlap(pair, start, full ? kQuestions : std::min(kQuestionsLazily, left),
                               evaluations);
  if (!inner) return;
  const double at_surface_mm = region.delta_mm.lo;
  const Interval delta{std::max(inner->depth_mm.lo, at_surface_mm),
                       std::max(inner->depth_mm.hi, at_surface_mm)};
  region.delta_mm = delta;
  if (inner->depth_mm.lo > at_surface_mm) region.point_W = inner->point_W;
  const auto widened = [&](const Interval& known, Layer layer) {
    const double reach_mm = pair.reach_mm(layer);
    const double by_mm = layer == Layer::kLower ? -reach_mm : reach_mm;
    // What the surfaces themselves say is known better; parts that do not meet meet nowhere inside.
    if (region.closed_form || layers_known || (!pair.trivial && known.hi <= 0.0)) return known;
    if (pair.trivial) return Interval{delta.lo + by_mm, delta.hi + by_mm};
    // An edge or corner travels farther than its faces are offset: what was found there stays, and
    // a point less deep than that in one of the parts may be far outside of its least body.
    const bool in_both = inner->in_either_mm > reach_mm;
    const double lo_mm = in_both ? std::max(known.lo, inner->depth_mm.lo - reach_mm) : known.lo;
    return Interval{lo_mm, std::max(lo_mm, delta.hi + reach_mm)};
  };
  region.certain_mm = widened(region.certain_mm, Layer::kLower);
  region.possible_mm = widened(region.possible_mm, Layer::kUpper);
  if (region.has_witness || layers_known || inner->in_either_mm <= pair.reach_mm(Layer::kLower))
    return;
  region.has_witness = true;
  region.witness_W = inner->point_W;
}

}  // namespace mortise
