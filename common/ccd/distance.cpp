#include <cmath>

#include "common/base/check.h"
#include "common/ccd/first_contact.h"
#include "common/ccd/pair_tree.h"

namespace mortise {
namespace {

using namespace ccd;

constexpr double kFar = std::numeric_limits<double>::infinity();

}  // namespace

// Best first; the first pops go straight down to the most promising leaf, whose distance then
// prunes.
DistanceResult distance(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                        CcdScratch& scratch, double limit_mm) {
  PairMotion motion(a, still_motion(X_WA), b, still_motion(X_WB));
  motion.at(0.0);
  CcdWork work;
  const BoxKernels& kernels = box_kernels();
  const BoxFrame& frame = motion.frame(0.0);
  std::vector<Item>& heap = scratch.heap;
  Nearest best;
  best.distance_mm = kFar;
  const auto reach_mm = [&] { return std::min(limit_mm, best.distance_mm); };
  heap.clear();
  heap.push_back(root_pair(a.bvh(), b.bvh()));
  while (!heap.empty()) {
    Item item = pop(heap);
    if (item.t > reach_mm() || best.distance_mm == 0.0) break;
    // Greedy: of the children the nearest is opened at once, the others wait.
    while (!is_leaf_pair(item)) {
      Item nearest = item;
      double nearest_mm = kFar;
      open(item, a.bvh(), b.bvh(), frame, kernels.lower_a, kernels.lower_b,
           [&](Item& child, double lower) {
             child.t = std::max(item.t, lower);
             if (child.t > reach_mm()) return;
             if (child.t < nearest_mm) {
               if (nearest_mm < kFar) push(heap, nearest);
               nearest = child;
               nearest_mm = child.t;
             } else {
               push(heap, child);
             }
           });
      if (nearest_mm == kFar) break;
      item = nearest;
    }
    if (!is_leaf_pair(item)) continue;
    LeafPair leaves(a.bvh(), item.a, b.bvh(), item.b);
    const Nearest found = leaves.nearest(motion, reach_mm(), work);
    if (found.distance_mm < best.distance_mm) best = found;
  }
  DistanceResult result;
  result.within_limit = best.distance_mm <= limit_mm && best.distance_mm < kFar;
  result.distance_mm = result.within_limit ? best.distance_mm : limit_mm;
  if (!result.within_limit) return result;
  result.triangle_a = best.triangle_a;
  result.triangle_b = best.triangle_b;
  result.point_a_W = motion.to_world(best.point_a, 0.0);
  result.point_b_W = motion.to_world(best.point_b, 0.0);
  return result;
}

bool surfaces_cross(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                    CcdScratch& scratch) {
  PairMotion motion(a, still_motion(X_WA), b, still_motion(X_WB));
  motion.at(0.0);
  CcdWork work;
  return each_leaf_pair_within(
      motion, a.bvh(), b.bvh(), motion.rounding_mm(), scratch, work, [&](LeafPair& leaves) {
        return leaves.nearest(motion, motion.rounding_mm(), work).distance_mm < kFar;
      });
}

// Slow, simple, and no proof of freedom: what first_contact is compared with.
FirstContact first_contact_by_sampling(const ContactQuery& query, int steps, CcdScratch& scratch) {
  MORTISE_CHECK(query.a != nullptr && query.b != nullptr && steps > 0, "two solids and a step");
  const double contact_mm = query.separation_mm + query.accuracy_mm;
  FirstContact result;
  const auto end = [&](ContactState state, double t, const DistanceResult& d) {
    result.state = state;
    result.t_contact = t;
    result.distance_mm = d.distance_mm;
    result.triangle_a = d.triangle_a;
    result.triangle_b = d.triangle_b;
    result.point_a_W = d.point_a_W;
    result.point_b_W = d.point_b_W;
    return result;
  };
  if (query.check_contained &&
      contained(*query.a, query.motion_a.X_W0, *query.b, query.motion_b.X_W0, query.accuracy_mm)) {
    result.contained = true;
    return end(ContactState::kOverlappingAtStart, 0.0, {});
  }
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const DistanceResult d = distance(*query.a, query.motion_a.pose_at(t), *query.b,
                                      query.motion_b.pose_at(t), scratch, contact_mm);
    if (d.within_limit) {
      if (i > 0) return end(ContactState::kContact, t, d);
      return end(
          d.distance_mm > 0.0 ? ContactState::kTouchingAtStart : ContactState::kOverlappingAtStart,
          0.0, d);
    }
    result.t_clear = t;
  }
  return end(ContactState::kFree, 1.0, {});
}

}  // namespace mortise
