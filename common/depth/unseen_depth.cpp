#include "common/depth/unseen_depth.h"

#include <algorithm>

#include "common/depth/region_report.h"

namespace mortise {
namespace {

// The other part comes into a crack: what it meets there is not known.
OverlapRegion region_at_crack(const PairFrame& pair, int role, const Crack& crack,
                              std::uint32_t nearest_of_k) {
  OverlapRegion region;
  const double depth = 2.0 * std::min({crack.reach_mm, pair.bodies[0].solid->sphere().radius_mm,
                                       pair.bodies[1].solid->sphere().radius_mm});
  region.delta_mm = region.possible_mm = {0.0, depth};
  region.certain_mm = {-depth, 0.0};
  region.at_crack = true;
  region.point_W = pair.X_W[role] * crack.center_mm;
  const std::uint32_t own = nearest_point(*pair.s(role).solid, crack.center_mm).triangle;
  region.triangle_a = region.deciding_triangle_a = role == 0 ? own : nearest_of_k;
  region.triangle_b = region.deciding_triangle_b = role == 0 ? nearest_of_k : own;
  region.normal_W = pair.X_W[1].q * pair.bodies[1].normal(region.triangle_b);
  for (int i = 0; i < 2; ++i)
    (i == 0 ? region.shape_a : region.shape_b) =
        face_shape(pair.bodies[i], i == 0 ? region.triangle_a : region.triangle_b,
                   pair.X_W[i].inverse() * region.point_W);
  region.points_W = {region.point_W};
  return region;
}

void mark_cracks_of(const PairFrame& pair, int role, bool tell, OverlapResult& result) {
  const Solid& solid = *pair.s(role).solid;
  if (!pair.s(role).has_inside) return;
  const Pose X_SW = pair.X_W[role].inverse();
  const Box& box = pair.k(role).solid->bounds();
  for (const Crack& crack : solid.cracks().all) {
    const Vec3 center_K = pair.X_KS[role] * crack.center_mm;
    const double reach_mm = crack.reach_mm + pair.near_mm;
    if ((center_K.array() < box.lo.array() - reach_mm).any() ||
        (center_K.array() > box.hi.array() + reach_mm).any())
      continue;
    const SurfacePoint at = nearest_surface(*pair.k(role).solid, center_K);
    ++result.evaluations;
    if (at.depth_mm < -reach_mm) continue;
    bool told = false;
    for (OverlapRegion& region : result.regions)
      if (crack.covers(X_SW * region.point_W) ||
          (region.has_witness && crack.covers(X_SW * region.witness_W)))
        region.at_crack = told = true;
    if (!told && tell) result.regions.push_back(region_at_crack(pair, role, crack, at.triangle));
  }
}

}  // namespace

void mark_cracks(const PairFrame& pair, bool tell, OverlapResult& result) {
  for (int role = 0; role < 2; ++role) mark_cracks_of(pair, role, tell, result);
}

// A point x of the inner part, y deep in it, has a point of its surface within y. So the depths at
// x exceed the deepest of the surface by 2 y at most, which is no more than the least extent.
void look_inside(const PairFrame& pair, OverlapResult& result) {
  const bool a_is_inner =
      pair.bodies[0].solid->sphere().radius_mm <= pair.bodies[1].solid->sphere().radius_mm;
  const int role = a_is_inner ? 0 : 1;
  const Solid &inner = *pair.s(role).solid, &outer = *pair.k(role).solid;
  if (result.regions.empty() || !inner.has_inside() || !outer.has_inside()) return;
  const auto depth = [&](const Vec3& x) {
    ++result.evaluations;
    const double own = nearest_surface(inner, x).depth_mm;
    const double other = nearest_surface(outer, pair.X_KS[role] * x).depth_mm;
    return own > 0.0 && other > 0.0 ? own + other : 0.0;
  };
  const Vec3 size = inner.bounds().hi - inner.bounds().lo;
  Vec3 at = inner.bounds().center();
  double deepest = depth(at);
  for (double step = 0.25 * size.maxCoeff(); step > kDepthAccuracyDefault_mm; step *= 0.5)
    for (int way = 0; way < 6; ++way) {
      Vec3 to = at;
      to[way / 2] += way % 2 == 0 ? step : -step;
      if (const double there = depth(to); there > deepest) {
        deepest = there;
        at = to;
      }
    }
  OverlapRegion& region = result.regions.front();
  const double more = std::max(0.0, deepest - region.delta_mm.lo), most = size.minCoeff();
  region.delta_mm = {region.delta_mm.lo + more,
                     std::max(region.delta_mm.lo + more, region.delta_mm.hi + most)};
  region.possible_mm.hi += std::max(more, most);
  region.certain_mm.hi += std::max(more, most);
  if (!pair.trivial) return;
  region.possible_mm.lo += more;
  region.certain_mm.lo += more;
}

}  // namespace mortise
