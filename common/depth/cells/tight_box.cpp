#include "common/depth/cells/tight_box.h"

#include <array>
#include <vector>

#include "common/base/constants.h"
#include "common/depth/cells/sharp_window.h"
#include "common/geometry/signed_distance.h"

namespace mortise {
namespace {

Box common(const Box& a, const Box& b) {
  Box both;
  both.lo = a.lo.cwiseMax(b.lo);
  both.hi = a.hi.cwiseMin(b.hi);
  return both;
}

bool holds(const Box& outer, const Box& inner) {
  return (outer.lo.array() <= inner.lo.array()).all() &&
         (inner.hi.array() <= outer.hi.array()).all();
}

// The box of the mesh within a box: of all facets, cut off there, and of the box's corners that are
// inside of it. What is the farthest of a part along an axis is on its border, or a whole side of
// the box is inside.
class MeshBox {
 public:
  MeshBox(const Solid& solid, const Pose& X_BS, const Box& within)
      : bvh_(solid.bvh()), X_BS_(X_BS), R_abs_(X_BS.rotation().cwiseAbs()), within_(within) {
    visit_facets();
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 at((corner & 1 ? within.hi : within.lo).x(),
                    (corner & 2 ? within.hi : within.lo).y(),
                    (corner & 4 ? within.hi : within.lo).z());
      if (!holds(found_, {at, at}) && inside(solid, X_BS.inverse() * at)) found_.add(at);
    }
  }

  const Box& found() const { return found_; }

 private:
  void visit_facets() {
    std::array<std::int32_t, Bvh::kMostWaiting> stack;
    int top = 0;
    stack[top++] = bvh_.root;
    while (top > 0) {
      const std::int32_t child = stack[--top];
      if (child < 0) {
        const Bvh::Leaf& leaf = bvh_.leaves[~child];
        for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) add(bvh_.corners[i]);
        continue;
      }
      const Bvh::Node& node = bvh_.nodes[child];
      for (int k = 0; k < node.count; ++k)
        if (is_news(in_B(bvh_.child_box(node, k)))) stack[top++] = node.child[k];
    }
  }

  Box in_B(const Box& box) const {
    const Vec3 center = X_BS_ * box.center(), half = R_abs_ * box.half();
    return {center - half, center + half};
  }

  bool is_news(const Box& box_B) const {
    const Box here = common(box_B, within_);
    return !here.empty() && !holds(found_, here);
  }

  void add(const std::array<double, 9>& c) {
    polygon_ = {X_BS_ * Vec3(c[0], c[1], c[2]), X_BS_ * Vec3(c[3], c[4], c[5]),
                X_BS_ * Vec3(c[6], c[7], c[8])};
    Box box;
    for (const Vec3& corner : polygon_) box.add(corner);
    if (!is_news(box)) return;
    for (int k = 0; k < 3 && !polygon_.empty(); ++k) {
      clip(polygon_, spare_, Vec3::Unit(k), within_.hi[k]);
      if (!polygon_.empty()) clip(polygon_, spare_, -Vec3::Unit(k), -within_.lo[k]);
    }
    for (const Vec3& corner : polygon_) found_.add(corner);
  }

  const Bvh& bvh_;
  const Pose X_BS_;
  const Mat3 R_abs_;
  const Box within_;
  Box found_;
  std::vector<Vec3> polygon_, spare_;  // at work
};

}  // namespace

Box tight_box(const SharpPart& part, const Pose& X_BS, const Box& box, double depth_mm) {
  const double by_mm = part.planes->most_travel.by_mm(depth_mm) +
                       kRoundingFactor * kUnitRoundoff * part.solid->bvh().extent_mm;
  const Box found = MeshBox(*part.solid, X_BS, box.grown(by_mm)).found();
  return found.empty() ? Box() : common(found.grown(by_mm), box);
}

}  // namespace mortise
