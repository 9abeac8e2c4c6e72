#pragma once
#include <algorithm>

#include "common/math/simplex.h"

namespace mortise {

/// A point of each of two convex bodies, in one frame.
struct PointOfEach {
  Vec3 k = Vec3::Zero(), s = Vec3::Zero();
  Vec3 across() const { return k - s; }
};

/// The direction from K to S along which they are farthest apart, or least deep in each other: that
/// in which D = K - S reaches least far (README, section 11). A local least where both overlap.
///
/// farthest(n): the point of K farthest along n, a unit vector, and that of S farthest against it.
/// tried(n, reach_mm): sees better and better directions, and says whether one is enough. size_mm:
/// about that of both.
template <class Farthest, class Tried>
class LeastReach {
 public:
  LeastReach(Farthest farthest, Tried tried, double size_mm)
      : farthest_(std::move(farthest)), tried_(std::move(tried)), size_mm_(size_mm) {}

  /// From a first direction, a unit vector. Looks no closer where both are seen to be deeper in
  /// each other than useless_mm, nor where two looks gained less than this share of the depth.
  void run(const Vec3& first, double useless_mm, double worth) {
    best_n_ = first;
    touching_ = best_ = farthest_(first);
    best_mm_ = best_.across().dot(first);
    if (tried_(first, best_mm_)) return;
    if (best_mm_ > useless_mm && (see_from(Vec3::Zero()) || best_mm_ > useless_mm)) return;
    for (double margin_mm = kFirstMargin * size_mm_; margin_mm > kLastMargin * size_mm_;
         margin_mm *= kCloser) {
      const double before_mm = best_mm_;
      const double out_mm = std::max(best_mm_, 0.0) + margin_mm;
      if (see_from(out_mm * best_n_)) return;
      if (before_mm - best_mm_ <= worth * std::max(best_mm_, 0.0)) margin_mm *= kCloser;
    }
  }

  /// Where both touch, or are least deep in each other; along n they are reach_mm apart.
  const PointOfEach& touching() const { return touching_; }

 private:
  // The point of D nearest to p, outside of D: what is across the way to it bounds D. True: enough.
  bool see_from(const Vec3& p) {
    Simplex<PointOfEach> simplex;
    simplex.add(best_.across() - p, best_);
    Vec3 v = simplex.nearest();
    double away = v.norm();
    for (int i = 0; i < kSteps; ++i) {
      if (!(away > kNowhere * size_mm_)) return false;
      const Vec3 n = -v / away;
      const PointOfEach x = farthest_(n);
      const double reach_mm = x.across().dot(n);
      if (reach_mm < best_mm_) {
        best_mm_ = reach_mm;
        best_n_ = n;
        best_ = x;
        if (tried_(n, reach_mm)) return true;
      }
      const Vec3 w = x.across() - p;
      if (away + w.dot(n) <= kGood * away) return false;  // nothing of D is nearer
      simplex.add(w, x);
      v = simplex.nearest();
      const double now = v.norm();
      if (!(now < away) || simplex.count == 4) return false;
      away = now;
      touching_ = {};
      for (int k = 0; k < simplex.count; ++k) {
        touching_.k += simplex.weight[k] * simplex.tag[k].k;
        touching_.s += simplex.weight[k] * simplex.tag[k].s;
      }
    }
    return false;
  }

  // Shares of the size: how far outside of D one stands, at first and last, and by how much closer
  // each time. Farther out round sides are met in fewer steps, closer by more exactly.
  static constexpr double kFirstMargin = 1e-3, kLastMargin = 1e-10, kCloser = 1e-2;
  static constexpr double kNowhere = 1e-14, kGood = 1e-9;
  static constexpr int kSteps = 16;

  Farthest farthest_;
  Tried tried_;
  const double size_mm_;
  Vec3 best_n_ = Vec3::UnitX();
  PointOfEach best_, touching_;
  double best_mm_ = 0.0;
};

}  // namespace mortise
