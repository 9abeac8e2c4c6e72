#pragma once
#include <limits>

#include "common/math/types.h"

namespace mortise {

/// Axis-aligned box; empty when lo > hi.
struct Box {
  Vec3 lo = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 hi = Vec3::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vec3& x) {
    lo = lo.cwiseMin(x);
    hi = hi.cwiseMax(x);
  }
  void add(const Box& b) {
    lo = lo.cwiseMin(b.lo);
    hi = hi.cwiseMax(b.hi);
  }
  Box grown(double margin_mm) const {
    Box b = *this;
    b.lo.array() -= margin_mm;
    b.hi.array() += margin_mm;
    return b;
  }
  bool empty() const { return (lo.array() > hi.array()).any(); }
  Vec3 center() const { return 0.5 * (lo + hi); }
  Vec3 half() const { return 0.5 * (hi - lo); }
  bool overlaps(const Box& b) const {
    return (lo.array() <= b.hi.array()).all() && (b.lo.array() <= hi.array()).all();
  }
};

}  // namespace mortise
