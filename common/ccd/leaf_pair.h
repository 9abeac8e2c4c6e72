#pragma once
#include "common/ccd/pair_motion.h"
#include "common/geometry/triangle_distance.h"

// Triangles of one leaf against triangles of another, in double: the one path from which every
// number of an answer comes.
namespace mortise::ccd {

/// What counts as contact, mm.
struct Goal {
  double contact_mm = 0.0;  ///< at or below this distance: contact
  double target_mm = 0.0;   ///< time is advanced to this distance, below contact_mm
  /// Distances go below zero: a pair of triangles that cross counts as minus the translation that
  /// takes them apart, and one right behind the other's back as minus its depth. Off, crossing
  /// counts as 0.
  bool below_zero = false;
  double exact_below_mm = 0.0;  ///< with below_zero: where the signed distance is asked for
};

struct Nearest {
  double distance_mm = std::numeric_limits<double>::infinity();
  std::uint32_t triangle_a = 0, triangle_b = 0;
  Vec3 point_a = Vec3::Zero(), point_b = Vec3::Zero();  ///< axes of B, from the origin of B's tree
  bool crossing = false;
};

struct LeafAdvance {
  double dt = 0.0;       ///< all pairs stay above the target for so long
  bool contact = false;  ///< `nearest` is in contact now
  Nearest nearest;       ///< the pair that was looked at last
};

/// The triangles of a pair of leaves at one time.
class LeafPair {
 public:
  LeafPair(const Bvh& a, std::int32_t leaf_a, const Bvh& b, std::int32_t leaf_b);

  /// At the time of motion.state(). `may_cross`: the pair is not known to be apart (t = 0).
  /// A time longer than `enough` is of no use to the caller.
  LeafAdvance advance(PairMotion& motion, const Goal& goal, bool may_cross, double enough,
                      LeafKernel kernel, CcdWork& work);

  /// Nearest pair below `limit_mm`; distance_mm is infinite when there is none. 0 when they cross.
  Nearest nearest(const PairMotion& motion, double limit_mm, CcdWork& work);

  /// Every pair of triangles at or below `limit_mm`, in order: f(nearest) -> bool, true to stop.
  template <class F>
  bool each_within(const PairMotion& motion, double limit_mm, CcdWork& work, F f) {
    place(motion);
    for (int i = 0; i < a_.count; ++i)
      for (int j = 0; j < b_.count; ++j) {
        if (boxes_apart(i, j, limit_mm)) continue;
        const Nearest found = exact(i, j, true, work);
        if (found.distance_mm <= limit_mm && f(found, x_[i], y_[j])) return true;
      }
    return false;
  }

  /// Largest speed at which the triangles of the last pair close along n, mm per tick.
  double closing_speed(const PairMotion& motion, const Vec3& n, const Triangle& a,
                       const Triangle& b) const;

 private:
  static constexpr int kMost = Bvh::kLeafSize;

  void place(const PairMotion& motion);
  bool boxes_apart(int i, int j, double limit_mm) const;
  Nearest exact(int i, int j, bool may_cross, CcdWork& work) const;
  /// For how long triangles i and j stay apart by more than taken_mm along n.
  double free_time(const LeafFrame& frame, const Vec3& n, int i, int j, double taken_mm) const;
  /// False when the pair is in contact; else result.dt is not longer than the pair is free.
  bool settle(const PairMotion& motion, const LeafFrame& frame, const Goal& goal, bool may_cross,
              int i, int j, LeafAdvance& result, CcdWork& work) const;

  const Bvh& bvh_a_;
  const Bvh& bvh_b_;
  std::uint32_t first_a_, first_b_;
  LeafCorners a_, b_;
  double placed_at_ = -1.0;
  Triangle x_[kMost];  // A, from the origin of B's tree, at the time placed_at_
  Triangle y_[kMost];  // B
};

}  // namespace mortise::ccd
