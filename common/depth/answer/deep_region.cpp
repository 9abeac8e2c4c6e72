#include "common/depth/answer/deep_region.h"

#include <algorithm>
#include <limits>

#include "common/depth/answer/convex_overlap.h"

namespace mortise {
namespace {

// Evaluations, some microseconds each; where they end, the depth is told as "at least".
constexpr std::uint64_t kQuestions = 80'000, kQuestionsLazily = 800;

// Twin points of duplicates are no farther apart than this share of the radius.
constexpr double kDuplicateShare = 0.01;
// Parts are in one place where the middle of one is this share of the smaller radius below both
// surfaces. The middle of a pin is in its hole, however tight it fits.
constexpr double kDeepShare = 0.1;
// Deeper than at the surfaces by this factor: that is not what the surfaces left open.
constexpr double kGrowth = 1.01;

}  // namespace

OverlapRegion region_of(const PairFrame& pair, const SharedInside& shared) {
  OverlapRegion region;
  region.delta_mm = {shared.depth_mm, pair.bodies[0].solid->sphere().radius_mm +
                                          pair.bodies[1].solid->sphere().radius_mm};
  region.certain_mm = {shared.depth_mm - pair.reach_mm(Layer::kLower), region.delta_mm.hi};
  region.possible_mm = {shared.depth_mm - pair.reach_mm(Layer::kUpper),
                        region.delta_mm.hi + pair.reach_mm(Layer::kUpper)};
  region.point_W = region.witness_W = shared.point_W;
  region.has_witness = shared.in_either_mm > pair.reach_mm(Layer::kLower);
  if (!region.has_witness) region.certain_mm.lo = std::min(0.0, region.certain_mm.lo);
  region.triangle_a = region.deciding_triangle_a = shared.triangle[0];
  region.triangle_b = region.deciding_triangle_b = shared.triangle[1];
  region.normal_W = -(pair.X_W[0].q * pair.bodies[0].normal(region.triangle_a));
  set_shapes(pair, region);
  region.points_W = {region.point_W};
  return region;
}

double twins_apart_mm(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB) {
  if (&a != &b) return std::numeric_limits<double>::infinity();
  const Pose X_AB = X_WA.inverse() * X_WB;
  const Vec3& center_mm = a.sphere().center_mm;
  return (X_AB * center_mm - center_mm).norm() + 2.0 * X_AB.q.vec().norm() * a.sphere().radius_mm;
}

bool are_duplicates(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB) {
  return twins_apart_mm(a, X_WA, b, X_WB) <= kDuplicateShare * a.sphere().radius_mm;
}

std::optional<OverlapRegion> find_in_one_place(const PairFrame& pair, const OverlapQuery& query,
                                               std::uint64_t& evaluations) {
  if (query.refinement != Refinement::kDecided || query.only_certain) return std::nullopt;
  const auto shared =
      are_duplicates(*query.a, query.X_WA, *query.b, query.X_WB)
          ? find_inside_of_twins(pair, evaluations)
          : find_middle_in_both(pair, kDeepShare * pair.smaller_radius_mm(), evaluations);
  if (!shared) return std::nullopt;
  OverlapRegion region = region_of(pair, *shared);
  if (!region.has_witness) return std::nullopt;
  for (const int i : {0, 1}) {
    const DeviationGrade grade = pair.bodies[i].face(shared->triangle[i]).grade;
    region.grade = std::max(region.grade, grade);
    region.estimated |= grade == DeviationGrade::kEstimated;
  }
  tell_inner_overlap(pair, query, {.from_inside = true}, region, evaluations);
  return region;
}

namespace {

// Of a layer, of which the surfaces showed what is known, and the meshes the overlap of region.
Interval of_layer(const PairFrame& pair, const InnerOverlap& inner, const OverlapRegion& region,
                  const Interval& known, Layer layer, bool grows) {
  const Interval& delta = region.delta_mm;
  const double reach_mm = pair.reach_mm(layer);
  const bool in_both = inner.in_either_mm > reach_mm;
  // What the surfaces themselves say is known better. Parts whose surfaces do not meet meet nowhere
  // inside, unless these lie in one another, as those of a part that is there twice.
  if (region.closed_form || (!pair.trivial && known.hi <= 0.0 && !in_both)) return known;
  if (pair.trivial && layer == Layer::kLower) return {delta.lo - reach_mm, delta.hi - reach_mm};
  if (pair.trivial) return {delta.lo + reach_mm, delta.hi + reach_mm};
  // An edge or corner travels farther than its faces are offset: what was found there stays, and
  // a point less deep than that in one of the parts may be far outside of its least body.
  const double lo_mm = in_both ? std::max(known.lo, inner.depth_mm.lo - reach_mm) : known.lo;
  // By triangles a face may be asked beyond a moved neighbour, by planes not.
  if (const auto most_mm = most_of_convex_layer_mm(pair, layer))
    return {std::min(lo_mm, *most_mm), *most_mm};
  return {lo_mm, std::max({lo_mm, delta.hi + reach_mm, grows ? lo_mm : known.hi})};
}

}  // namespace

void tell_inner_overlap(const PairFrame& pair, const OverlapQuery& query,
                        const BeforeInside& before, OverlapRegion& region,
                        std::uint64_t& evaluations) {
  if (region.at_crack || region.delta_mm.lo < -pair.touch_mm) return;  // not known, or apart
  const bool full = query.refinement == Refinement::kFull;
  InnerStart start;
  const Vec3 deepest[] = {region.point_W};
  start.points_W = full ? std::span<const Vec3>(region.points_W) : std::span<const Vec3>(deepest);
  start.depth_mm = std::max(0.0, region.delta_mm.lo);
  start.everywhere = full;
  start.inside = before.from_inside;
  if (region.closed_form) start.expected_mm = before.closed_form_mm;
  start.accuracy_mm = query.accuracy_mm;
  const std::uint64_t left = query.work_cap - std::min(query.work_cap, evaluations);
  auto inner = convex_overlap(pair, region.point_W, query.accuracy_mm, evaluations);
  if (!inner)
    inner = find_inner_overlap(pair, start, full ? kQuestions : std::min(kQuestionsLazily, left),
                               evaluations);
  if (!inner) return;
  const double at_surface_mm = region.delta_mm.lo;
  if (!inner->grows) {
    region.delta_mm.hi = std::min(region.delta_mm.hi, std::max(inner->depth_mm.hi, at_surface_mm));
    return;
  }
  Interval delta{std::max(inner->depth_mm.lo, at_surface_mm),
                 std::max(inner->depth_mm.hi, at_surface_mm)};
  if (region.closed_form && delta.lo <= before.closed_form_mm)
    delta.hi = std::min(delta.hi, before.closed_form_mm);
  region.delta_mm = delta;
  if (inner->depth_mm.lo > at_surface_mm) region.point_W = inner->point_W;
  const bool grows = before.from_inside || delta.lo > kGrowth * at_surface_mm + pair.touch_mm;
  if (before.layers && !grows) return;
  region.certain_mm = of_layer(pair, *inner, region, region.certain_mm, Layer::kLower, grows);
  region.possible_mm = of_layer(pair, *inner, region, region.possible_mm, Layer::kUpper, grows);
  if (region.has_witness && region.certain_mm.hi <= 0.0) {
    region.has_witness = false;
    ++region.witnesses_refused;
  }
  if (region.has_witness || region.certain_mm.hi <= 0.0) return;
  const double reach_mm = pair.reach_mm(Layer::kLower);
  if (inner->in_either_mm <= reach_mm) {
    inner = convex_inside_both(pair, inner->point_W, reach_mm, evaluations);
    if (!inner) return;
    region.certain_mm.lo =
        std::clamp(inner->depth_mm.lo - reach_mm, region.certain_mm.lo, region.certain_mm.hi);
  }
  region.has_witness = true;
  region.witness_W = inner->point_W;
}

}  // namespace mortise
