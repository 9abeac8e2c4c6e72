#include "common/ccd/distance.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"
#include "common/ccd/hull_gap.h"
#include "common/ccd/pair_tree.h"

namespace mortise {
namespace {

using namespace ccd;

constexpr double kFar = std::numeric_limits<double>::infinity();

// Node pairs opened before the hulls are asked for a plane. Most pairs of boxes are done by then;
// far apart curved faces are not, and a plane costs about as much as this.
constexpr int kOpenedBeforePlane = 64;
// Where the nearest pair of an earlier answer is known, the plane across it costs little.
constexpr int kOpenedBeforeSeedPlane = 24;
// Steps to the plane between the hulls: mostly a few; nearly parallel faces would take many.
constexpr int kPlaneSteps = 32;
// Leaves over the plane across a seed, on either side: more of them are not cheap any more.
constexpr int kMostSeedLeaves = 64;

// The nearest pair of triangles below a limit. Boxes, planes and the leaf kernels only discard:
// every distance comes from the double triangles.
class Search {
 public:
  Search(PairMotion& motion, const Bvh& a, const Bvh& b, double limit_mm, double enough_mm,
         CcdScratch& scratch)
      : motion_(motion),
        a_(a),
        b_(b),
        limit_mm_(limit_mm),
        enough_mm_(enough_mm),
        scratch_(scratch) {
    const PairState& s = motion.state();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) placement_.r[i][j] = s.R(i, j);
      placement_.p[i] = s.p[i];
      placement_.origin[i] = a.origin[i];
    }
    best_.distance_mm = kFar;
  }

  // The pair of triangles of an earlier answer, by their ids in the meshes.
  void begin_with(const Solid& a, std::uint32_t id_a, const Solid& b, std::uint32_t id_b) {
    if (id_a >= a.mesh().triangles.size() || id_b >= b.mesh().triangles.size()) return;
    Triangle x, y;
    for (int k = 0; k < 3; ++k) {
      x[k] = place_a(a.mesh().corner(id_a, k));
      y[k] = b.mesh().corner(id_b, k) - b_.origin;
    }
    seeded_ = nearer(x, y, id_a, id_b);
  }

  // Depth first, of the children the nearest first: the first pops go straight
  // down to the most promising leaves, whose distance then prunes. Where only a
  // crossing is wanted, those first that overlap most.
  const Nearest& run() {
    const BoxKernels& kernels = best_kernels().box;
    const bool overlap_first = enough_mm_ > 0.0;
    std::vector<Item>& stack = scratch_.heap;
    stack.clear();
    stack.push_back(root_pair(a_, b_));
    int opened = 0;
    while (!stack.empty() && !done()) {
      const Item item = stack.back();
      stack.pop_back();
      if (item.t > reach_mm()) continue;
      if (is_leaf_pair(item)) {
        leaf_pair(item.a, item.b);
        continue;
      }
      ++opened;
      if (seeded_ && opened == kOpenedBeforeSeedPlane && by_plane(1, kMostSeedLeaves)) break;
      if (opened == kOpenedBeforePlane && by_plane(kPlaneSteps, kMostLeaves)) break;
      const std::size_t begin = stack.size();
      alignas(32) float value[Bvh::kWidth];
      const bool opened_a =
          open_still(item, a_, b_, motion_, overlap_first ? kernels.apart_a : kernels.lower_a,
                     overlap_first ? kernels.apart_b : kernels.lower_b, value);
      each_child(item, a_, b_, opened_a, value, [&](Item& child, double lower) {
        child.t = overlap_first ? lower : std::max(item.t, lower);
        if (child.t > reach_mm()) return;
        std::size_t at = stack.size();
        stack.push_back(child);
        for (; at > begin && stack[at - 1].t < child.t; --at) stack[at] = stack[at - 1];
        stack[at] = child;
      });
    }
    return best_;
  }

 private:
  double reach_mm() const { return std::min(limit_mm_, best_.distance_mm); }
  bool done() const { return best_.distance_mm <= enough_mm_; }

  Vec3 place_a(const Vec3& x) const {
    const PairState& s = motion_.state();
    return s.R * (x - a_.origin) + s.p;
  }
  static Vec3 corner(const Bvh& bvh, std::uint32_t i, int k) {
    const auto& c = bvh.corners[i];
    return {c[3 * k], c[3 * k + 1], c[3 * k + 2]};
  }

  Reach reach() const {
    Reach r;
    r.mm = reach_mm() + motion_.rounding_mm();
    for (int c = 0; c < 3; ++c) r.n[c] = n_[c];
    return r;
  }

  void leaf_pair(std::int32_t leaf_a, std::int32_t leaf_b) {
    const Bvh::Leaf& a = a_.leaves[~leaf_a];
    const Bvh::Leaf& b = b_.leaves[~leaf_b];
    FourTriangles y;
    if (leaf_a != placed_leaf_) {
      kernels_.place(a_.corners[a.first].data(), static_cast<int>(a.count), placement_, placed_);
      placed_leaf_ = leaf_a;
    }
    kernels_.move(b_.corners[b.first].data(), static_cast<int>(b.count), b_.origin.data(), y);
    unsigned left = kernels_.near_pairs(placed_, y, reach());
    for (std::uint32_t i = 0; i < a.count; ++i)
      for (std::uint32_t j = 0; j < b.count; ++j) {
        if ((left >> (4 * i + j) & 1U) == 0) continue;
        if (nearer(a.first + i, b.first + j)) {
          if (done()) return;
          left &= kernels_.near_along(placed_, y, reach());
        }
      }
  }

  // The triangles i and j in the order of the trees. True when they are the nearest so far.
  bool nearer(std::uint32_t i, std::uint32_t j) {
    Triangle x, y;
    for (int k = 0; k < 3; ++k) {
      x[k] = place_a(corner(a_, i, k));
      y[k] = corner(b_, j, k) - b_.origin;
    }
    return nearer(x, y, a_.triangle_order[i], b_.triangle_order[j]);
  }

  bool nearer(const Triangle& x, const Triangle& y, std::uint32_t id_a, std::uint32_t id_b) {
    const TriangleDistance d = triangle_distance(x, y);
    if (!(d.distance_mm < best_.distance_mm && d.distance_mm <= limit_mm_)) return false;
    best_ = {d.distance_mm, id_a, id_b, d.point_a, d.point_b, d.crossing};
    if (d.distance_mm > 0.0) n_ = (d.point_b - d.point_a) / d.distance_mm;
    return true;
  }

  // The plane between the hulls. Only triangles that reach over it farther than the nearest pair so
  // far can be in a nearer pair: when they are few, their pairs are all that is left to look at.
  bool by_plane(int steps, int most_leaves) {
    const PairState& s = motion_.state();
    const HullGap hulls = hull_gap(
        motion_, a_, b_, n_.isZero(0.0) ? Vec3(-s.p) : Vec3(best_.distance_mm * n_), steps);
    if (!hulls.apart) return false;
    if (hulls.gap_mm - motion_.rounding_mm() > reach_mm()) return true;
    for (int k = 0; k < hulls.pairs; ++k)
      for (int m = 0; m < hulls.pairs; ++m) leaf_pair(hulls.leaf_a[k], hulls.leaf_b[m]);
    LeafList list_a, list_b;
    const double over_mm = reach_mm() + motion_.rounding_mm();
    // Heights are taken from the origin of each tree.
    const double a_mm = hulls.n.dot(s.p);
    if (!leaves_above(a_, s.R.transpose() * hulls.n, hulls.near_b_mm - over_mm - a_mm, list_a,
                      most_leaves) ||
        !leaves_above(b_, -hulls.n, -(hulls.far_a_mm + over_mm), list_b, most_leaves))
      return false;
    if (list_a.count * list_b.count > kMostPlanePairs) return false;
    const auto by_height = [](const LeafHeight& x, const LeafHeight& y) {
      return x.along_mm != y.along_mm ? x.along_mm > y.along_mm : x.leaf > y.leaf;
    };
    std::sort(list_a.leaf.begin(), list_a.leaf.begin() + list_a.count, by_height);
    std::sort(list_b.leaf.begin(), list_b.leaf.begin() + list_b.count, by_height);
    for (int i = 0; i < list_a.count; ++i)
      for (int j = 0; j < list_b.count; ++j) {
        const double gap = -list_b.leaf[j].along_mm - (list_a.leaf[i].along_mm + a_mm);
        if (gap > reach_mm() + motion_.rounding_mm()) break;
        leaf_pair(list_a.leaf[i].leaf, list_b.leaf[j].leaf);
      }
    return true;
  }

  static constexpr int kMostPlanePairs = 1 << 14;  // more are left to the trees, which prune

  PairMotion& motion_;
  const Bvh& a_;
  const Bvh& b_;
  double limit_mm_, enough_mm_;
  CcdScratch& scratch_;
  const DiscardKernels& kernels_ = best_kernels().discard;
  Placement placement_;
  FourTriangles placed_;
  std::int32_t placed_leaf_ = 0;  // leaves are below zero
  Nearest best_;
  Vec3 n_ = Vec3::Zero();
  bool seeded_ = false;
};

void check(const Solid& a, const Solid& b, const DistanceResult& result) {
  MORTISE_CHECK(result.distance_mm >= 0.0, "a distance is not negative");
  MORTISE_CHECK(result.triangle_a < a.mesh().triangles.size() &&
                    result.triangle_b < b.mesh().triangles.size(),
                "the nearest triangles are those of the parts");
  MORTISE_CHECK(result.point_a_W.allFinite() && result.point_b_W.allFinite(),
                "the nearest points are finite");
}

}  // namespace

DistanceResult distance(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                        CcdScratch& scratch, double limit_mm, const DistanceResult* seed) {
  MORTISE_CHECK(limit_mm >= 0.0, "a limit must be a length");
  MORTISE_CHECK(valid(X_WA) && valid(X_WB), "poses must be finite and their quaternions unit");
  PairMotion motion(a, still_motion(X_WA), b, still_motion(X_WB));
  motion.at(0.0);
  Search search(motion, a.bvh(), b.bvh(), limit_mm, 0.0, scratch);
  if (seed != nullptr && seed->within_limit)
    search.begin_with(a, seed->triangle_a, b, seed->triangle_b);
  const Nearest best = search.run();
  DistanceResult result;
  result.within_limit = best.distance_mm <= limit_mm && best.distance_mm < kFar;
  result.distance_mm = result.within_limit ? best.distance_mm : limit_mm;
  if (!result.within_limit) return result;
  result.triangle_a = best.triangle_a;
  result.triangle_b = best.triangle_b;
  result.point_a_W = motion.to_world(best.point_a, 0.0);
  result.point_b_W = motion.to_world(best.point_b, 0.0);
  check(a, b, result);
  return result;
}

bool surfaces_cross(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                    CcdScratch& scratch) {
  PairMotion motion(a, still_motion(X_WA), b, still_motion(X_WB));
  motion.at(0.0);
  const double rounding_mm = motion.rounding_mm();
  return Search(motion, a.bvh(), b.bvh(), rounding_mm, rounding_mm, scratch).run().distance_mm <
         kFar;
}

}  // namespace mortise
