#include "common/ccd/first_contact.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/base/check.h"
#include "common/ccd/distance.h"
#include "common/ccd/leaf_pair.h"
#include "common/ccd/pair_queue.h"
#include "common/ccd/screw_bounds.h"
#include "common/ccd/start_state.h"

namespace mortise {
namespace {

using namespace ccd;

// In units of the accuracy: contact is said at a quarter of it, so that the time is good even where
// surfaces meet at a small angle; time is advanced to a 32nd. Convergence is quadratic: the finer
// end costs a step or none. Rounding still lies below the difference.
constexpr double kContactAt = 0.25;
constexpr double kAim = 0.03125;
// The finest accuracy, in roundings of the pair: contact and aim are then 14 of them apart.
constexpr double kRoundingsPerAccuracy = 64.0;
// Ticks: for less than this a pair is not put back, but looked at by its exact distance.
constexpr double kWorthWhile = 0.03;
// Of a pair that touches at the start: how deep its triangles may go, and how much deeper those may
// that already lie near that depth and only slide.
constexpr double kMayPress = 0.875;
constexpr double kMaySlideDeeper = 0.125;
// ScrewBounds makes a bound for each leaf; that costs half as much as a look at a pair of them.
constexpr std::size_t kLeavesPerLook = 2;

class Query {
 public:
  Query(const ContactQuery& query, CcdScratch& scratch)
      : query_(query),
        scratch_(scratch),
        a_(*query.a),
        b_(*query.b),
        tree_a_(a_.bvh()),
        tree_b_(b_.bvh()),
        motion_(a_, query.motion_a, b_, query.motion_b),
        accuracy_mm_(std::max(query.accuracy_mm, kRoundingsPerAccuracy * motion_.rounding_mm())),
        kernels_(query.portable ? portable_kernels() : best_kernels()) {}

  // 1. spheres too far for the tick.
  // 2. one inside the other: no surface need ever meet.
  // 3. the trees; a contact at t = 0 is looked at more closely.
  // 4. those that only touch at the start, if wanted, once more with distances below zero.
  FirstContact answer() {
    const double apart_mm =
        motion_.at(0.0).p.norm() - tree_a_.radius_mm - tree_b_.radius_mm - motion_.rounding_mm();
    if (apart_mm - motion_.travel_mm() > query_.separation_mm + accuracy_mm_) {
      result_.state = ContactState::kFree;
      result_.t_clear = result_.t_contact = 1.0;
      result_.distance_mm = apart_mm - motion_.travel_mm();
      return result_;
    }
    if (query_.check_contained && query_.t_from == 0.0 && apart_mm <= 0.0 &&
        contained(a_, query_.motion_a.X_W0, b_, query_.motion_b.X_W0, accuracy_mm_)) {
      result_.contained = true;
      return at_start(ContactState::kOverlappingAtStart, {});
    }
    Goal goal;
    goal.contact_mm = query_.separation_mm + kContactAt * accuracy_mm_;
    goal.target_mm = query_.separation_mm + kAim * accuracy_mm_;
    run(goal);
    if (result_.state == ContactState::kContact && result_.t_contact == 0.0) start();
    return result_;
  }

 private:
  FirstContact at_start(ContactState state, const Nearest& nearest) {
    result_.state = state;
    result_.t_clear = result_.t_contact = 0.0;
    if (std::isfinite(nearest.distance_mm)) set(nearest, 0.0);
    result_.distance_mm =
        std::isfinite(nearest.distance_mm) ? std::max(0.0, nearest.distance_mm) : 0.0;
    return result_;
  }

  void set(const Nearest& nearest, double t) {
    result_.distance_mm = nearest.distance_mm;
    result_.triangle_a = nearest.triangle_a;
    result_.triangle_b = nearest.triangle_b;
    result_.point_a_W = motion_.to_world(nearest.point_a, t);
    result_.point_b_W = motion_.to_world(nearest.point_b, t);
  }

  void start() {
    motion_.at(0.0);
    StartQuery start_query;
    start_query.contact_mm = query_.separation_mm + kContactAt * accuracy_mm_;
    start_query.accuracy_mm = accuracy_mm_;
    start_query.deep_mm = query_.separation_mm - kMayPress * accuracy_mm_;
    const StartState start = start_state(motion_, a_, b_, start_query, scratch_, result_.work);
    if (start.overlapping) {
      result_.contained = start.skin_shared;
      at_start(ContactState::kOverlappingAtStart, start.nearest);
      return;
    }
    at_start(ContactState::kTouchingAtStart, start.nearest);
    if (!query_.ignore_touching_at_start) return;
    result_.touched_at_start = true;
    const double start_mm = start.nearest.distance_mm;
    if (start.pressing) {
      result_.state = ContactState::kContact;
      return;
    }
    // A pair that already lies near the limit and only slides gets a new limit just below.
    Goal goal;
    goal.below_zero = true;
    goal.exact_below_mm = query_.separation_mm + 2.0 * accuracy_mm_;
    goal.contact_mm = query_.separation_mm - kMayPress * accuracy_mm_;
    if (start_mm <= goal.contact_mm)
      goal.contact_mm = start_mm - 0.5 * kMaySlideDeeper * accuracy_mm_;
    goal.target_mm = goal.contact_mm - 0.5 * kMaySlideDeeper * accuracy_mm_;
    run(goal);
  }

  void run(const Goal& goal) {
    CcdWork& work = result_.work;
    PairQueue queue(tree_a_, tree_b_, scratch_);
    screw_.reset();
    screw_after_ =
        work.leaf_tests + (tree_a_.leaves.size() + tree_b_.leaves.size()) / kLeavesPerLook;
    Item root = root_pair(tree_a_, tree_b_);
    root.t = query_.t_from;
    queue.push_now(root);
    while (!queue.empty()) {
      const Item item = queue.pop();
      if (work.box_tests + work.leaf_tests >= query_.work_cap) {
        undecided(item.t);
        return;
      }
      if (begins_with_screw(item.t)) {
        // From the root once more: all pairs are free before this one.
        screw_.emplace(motion_, tree_a_, tree_b_, goal.contact_mm, scratch_);
        root.t = item.t;
        queue.clear();
        queue.push_now(root);
      } else if (!is_leaf_pair(item)) {
        open_pair(item, goal, queue);
      } else if (!advance_leaf(item, goal, queue)) {
        return;
      }
    }
    result_.state = ContactState::kFree;
    result_.t_clear = result_.t_contact = 1.0;
    result_.distance_mm = 0.0;
  }

  // What a screw leaves alone is asked when a query that turns far has cost as much as that costs.
  bool begins_with_screw(double t) {
    return !screw_.has_value() && result_.work.leaf_tests >= screw_after_ &&
           ScrewBounds::applies(motion_, tree_a_, tree_b_, t);
  }

  void open_pair(const Item& item, const Goal& goal, PairQueue& queue) {
    ++result_.work.box_tests;
    alignas(32) float dt[Bvh::kWidth], kept[Bvh::kWidth];
    if (screw_.has_value() && screw_->keeps_children(item, kept)) return;
    motion_.at(item.t);
    // At the start a pair within contact_mm must be seen.
    const double taken_mm = item.t == 0.0 ? goal.contact_mm : goal.target_mm;
    const bool opened_a =
        open_oriented(item, tree_a_, tree_b_, motion_, taken_mm, kernels_.box, dt);
    if (screw_.has_value())
      for (int k = 0; k < Bvh::kWidth; ++k) dt[k] = std::max(dt[k], kept[k]);
    queue.push_children(item, opened_a, dt);
  }

  // Advances while the pair is the earliest of all. False when the query is decided.
  bool advance_leaf(const Item& item, const Goal& goal, PairQueue& queue) {
    LeafPair leaves(tree_a_, item.a, tree_b_, item.b);
    double t = item.t;
    while (true) {
      motion_.at(t);
      ++result_.work.advances;
      const double next_pair = queue.next_time(t);
      const LeafAdvance advance =
          leaves.advance(motion_, goal, t == 0.0, std::max(kWorthWhile, next_pair - t),
                         kernels_.leaf, result_.work);
      if (advance.contact) {
        contact(advance.nearest, t);
        return false;
      }
      const double next = t + advance.dt;
      if (next >= 1.0) return true;
      const bool stuck = next == t;  // rounding leaves no step that is proven free
      if (stuck && !goal.below_zero &&
          advance.nearest.distance_mm <= query_.separation_mm + accuracy_mm_) {
        contact(advance.nearest, t);
        return false;
      }
      if (stuck || result_.work.box_tests + result_.work.leaf_tests >= query_.work_cap) {
        undecided(t);
        return false;
      }
      t = next;
      if (screw_.has_value()) t = std::max(t, screw_->free_until(item.a, item.b, t));
      if (t >= 1.0) return true;
      if (t > next_pair) {
        Item again = item;
        again.t = t;
        queue.push_again(again);
        return true;
      }
    }
  }

  void contact(const Nearest& nearest, double t) {
    result_.state = ContactState::kContact;
    result_.t_clear = result_.t_contact = t;
    set(nearest, t);
  }

  void undecided(double t) {
    result_.state = ContactState::kUndecided;
    result_.t_clear = t;
    result_.t_contact = 1.0;
    result_.distance_mm = 0.0;
  }

  const ContactQuery& query_;
  CcdScratch& scratch_;
  const Solid& a_;
  const Solid& b_;
  const Bvh& tree_a_;
  const Bvh& tree_b_;
  PairMotion motion_;
  double accuracy_mm_;
  const Kernels& kernels_;
  std::optional<ScrewBounds> screw_;
  std::uint64_t screw_after_ = 0;  // looks at pairs of leaves
  FirstContact result_;
};

void check(const ContactQuery& query) {
  MORTISE_CHECK(query.a != nullptr && query.b != nullptr, "a query needs two solids");
  MORTISE_CHECK(valid(query.motion_a) && valid(query.motion_b),
                "poses must be finite and unit, rotations at most half a turn");
  MORTISE_CHECK(query.accuracy_mm >= 0.0 && query.accuracy_mm <= kLargestCoordinate_mm,
                "an accuracy must be a length");
  MORTISE_CHECK(query.separation_mm >= 0.0 && query.separation_mm <= kLargestCoordinate_mm,
                "a separation must be a length");
  MORTISE_CHECK(query.t_from >= 0.0 && query.t_from < 1.0, "t_from must be a time of the tick");
}

}  // namespace

FirstContact first_contact(const ContactQuery& query, CcdScratch& scratch) {
  check(query);
  const FirstContact found = Query(query, scratch).answer();
  MORTISE_CHECK(found.state != ContactState::kUnknown && 0.0 <= found.t_clear &&
                    found.t_clear <= found.t_contact && found.t_contact <= 1.0,
                "a query has an answer, its times are ordered");
  return found;
}

// Slow, simple, and no proof of freedom: what first_contact is compared with.
FirstContact first_contact_by_sampling(const ContactQuery& query, int steps, CcdScratch& scratch) {
  check(query);
  MORTISE_CHECK(steps > 0, "sampling needs a step");
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
