#include "common/depth/answer/inner_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "common/depth/answer/convex_overlap.h"
#include "common/depth/answer/facet.h"
#include "common/depth/triangles_in.h"
#include "common/geometry/signed_distance.h"

namespace mortise {
namespace {

// Lazily a bracket is narrow enough at this share of the depth: what is told of parts that lie deep
// in each other is how deep, not to the micrometre.
constexpr double kNarrowShare = 0.005;
// Lazily the overlap is said to grow away from the surface when it does by more than this share.
constexpr double kGrowsAway = 0.01;
// Lazily: work in which something deeper than at the surfaces is found where the overlap grows away
// from them.
constexpr std::uint64_t kMostInVain = 600;
// Work in which something deeper than expected is found.
constexpr std::uint64_t kMostAsExpected = 8000;
// A cut that leaves more than this share of what its box exceeds the best by hardly helps. With 0.9
// a key in its slot is not closed.
constexpr double kHardly = 0.75;
// In full it begins anew after so much work, and cuts across any axis: about balls cubes mostly
// come to an end within 12,000, along faces hardly ever.
constexpr std::uint64_t kCubesOnly = 20'000;
// The climb from a new best point ends at this share of its first step.
constexpr int kClimbHalvings = 8;

// Of one part, for a box: the face nearest to its middle, and the one that is nearest on the far
// side of it.
struct Faces {
  std::array<std::uint32_t, 2> triangle;
  std::array<bool, 2> is_below;  ///< all of the box: then its plane counts
};

// A box of space in frame B and what is known of the points in it.
struct Cell {
  Vec3 center, half;
  std::array<Faces, 2> faces;
  double most_mm = 0.0;  ///< no point in both parts is deeper
  std::uint32_t number = 0;
};
struct LessPromising {
  bool operator()(const Cell& x, const Cell& y) const {
    return x.most_mm != y.most_mm ? x.most_mm < y.most_mm : x.number > y.number;
  }
};

using CellCorners = std::array<Vec3, 8>;

CellCorners corners_of(const Cell& cell) {
  CellCorners corners;
  for (int i = 0; i < 8; ++i)
    corners[static_cast<std::size_t>(i)] =
        cell.center + Vec3(i & 1 ? cell.half.x() : -cell.half.x(),
                           i & 2 ? cell.half.y() : -cell.half.y(),
                           i & 4 ? cell.half.z() : -cell.half.z());
  return corners;
}

std::array<int, 3> longest_first(const Vec3& half) {
  std::array<int, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](int x, int y) { return half[x] > half[y]; });
  return axes;
}

class InnerSearch {
 public:
  InnerSearch(const PairFrame& pair, const InnerStart& start, std::uint64_t work_cap,
              std::uint64_t& evaluations)
      : pair_(pair),
        anew_at_(start.everywhere ? work_cap - std::min(work_cap, kCubesOnly) : 0),
        start_mm_(start.inside ? 0.0 : start.depth_mm),
        growth_(start.everywhere ? 0.0 : kGrowsAway),
        narrow_(start.everywhere ? 0.0 : kNarrowShare),
        accuracy_mm_(std::max(start.accuracy_mm, pair.touch_mm)),
        expected_mm_(start.expected_mm),
        thin_mm_(std::min(half_extent_mm(0), half_extent_mm(1))),
        left_(work_cap),
        in_vain_(start.everywhere ? work_cap : kMostInVain),
        evaluations_(evaluations) {}

  bool is_inside(const Vec3& from_B) { return look_at(from_B) > 0.0; }

  // The overlap at a point of one surface grows inwards where the other surface is not what is
  // nearest there.
  bool grows_from(const Vec3& from_B) {
    start_mm_ = std::max(start_mm_, look_at(from_B));
    const SurfacePoint at[2] = {surface(0, from_B), surface(1, from_B)};
    const int on = std::fabs(at[0].depth_mm) <= std::fabs(at[1].depth_mm) ? 0 : 1;
    const Vec3 inwards_B = on == 0 ? Vec3(pair_.X_KS[0].q * -at[0].outward) : Vec3(-at[1].outward);
    for (const double step_mm : {0.5 * start_mm_, 0.1 * thin_mm_, 0.9 * thin_mm_}) {
      if (has_grown()) return true;
      look_at(from_B + step_mm * inwards_B);
    }
    return has_grown();
  }

  bool has_grown() const { return best_mm_ > (1.0 + growth_) * start_mm_ + pair_.touch_mm; }

  // Gives up where so much work has found nothing that is deeper than the start. True: nothing is
  // deeper than found.
  bool search() {
    if (has_grown()) climb(0.5 * thin_mm_);
    const std::uint64_t give_up_at = left_ - std::min(left_, in_vain_);
    const std::uint64_t as_expected_at = left_ - std::min(left_, kMostAsExpected);
    begin();
    while (!open_.empty()) {
      if (left_ < anew_at_ && !std::exchange(cuts_any_axis_, true)) begin();
      const Cell cell = open_.top();
      most_mm_ = std::max(known_mm(), cell.most_mm);
      if (most_mm_ <= known_mm() + narrow_mm()) return true;
      if (left_ == 0 || (left_ <= give_up_at && !has_grown())) return false;
      if (left_ <= as_expected_at && best_mm_ <= expected_mm_) return false;
      open_.pop();
      most_mm_ = known_mm();
      split(cell);
    }
    return true;
  }

  InnerOverlap found() const {
    return {{best_mm_, most_mm_ + 4.0 * pair_.rounding_mm},
            pair_.X_W[1] * best_B_,
            in_either_mm_,
            has_grown()};
  }

 private:
  double half_extent_mm(int body) const {
    const Box& box = pair_.bodies[body].solid->bounds();
    return 0.5 * (box.hi - box.lo).minCoeff();
  }
  // Something is so deep: inside, or at the surfaces.
  double known_mm() const { return std::max(best_mm_, start_mm_); }
  double narrow_mm() const { return std::max(narrow_ * best_mm_, accuracy_mm_); }

  SurfacePoint surface(int body, const Vec3& x_B) {
    ++evaluations_;
    left_ -= left_ > 0 ? 1 : 0;
    const Vec3 x = body == 0 ? Vec3(pair_.X_KS[1] * x_B) : x_B;
    return nearest_surface(*pair_.bodies[body].solid, x, near_[body]);
  }

  // Depth of the point in both; at most 0 where it is outside one of them.
  double look_at(const Vec3& x_B) {
    double sum_mm = 0.0, least_mm = std::numeric_limits<double>::infinity();
    for (int body = 0; body < 2; ++body) {
      const SurfacePoint at = surface(body, x_B);
      near_[body] = at.triangle;
      if (at.depth_mm <= 0.0) return 0.0;
      sum_mm += at.depth_mm;
      least_mm = std::min(least_mm, at.depth_mm);
    }
    if (sum_mm > best_mm_) {
      in_either_mm_ = least_mm;
      best_mm_ = sum_mm;
      best_B_ = x_B;
    }
    return sum_mm;
  }

  // Uphill from the best point along the axes of the frame, in ever smaller steps.
  void climb(double step_mm) {
    for (int i = 0; i < kClimbHalvings && left_ > 0; ++i, step_mm *= 0.5) {
      bool better = true;
      while (better && left_ > 0) {
        const double before_mm = best_mm_;
        const Vec3 from = best_B_;
        for (int k = 0; k < 3; ++k)
          for (const double sign : {1.0, -1.0}) look_at(from + sign * step_mm * Vec3::Unit(k));
        better = best_mm_ > before_mm + 0.1 * step_mm;
      }
    }
  }

  // The smallest box around what both can have in common.
  Cell root() const {
    Box of_a;
    const Box& bounds = pair_.bodies[0].solid->bounds();
    for (int i = 0; i < 8; ++i)
      of_a.add(pair_.X_KS[0] * Vec3(i & 1 ? bounds.hi.x() : bounds.lo.x(),
                                    i & 2 ? bounds.hi.y() : bounds.lo.y(),
                                    i & 4 ? bounds.hi.z() : bounds.lo.z()));
    const Box& of_b = pair_.bodies[1].solid->bounds();
    const Vec3 lo = of_a.lo.cwiseMax(of_b.lo), hi = of_a.hi.cwiseMin(of_b.hi).cwiseMax(lo);
    return {0.5 * (lo + hi), 0.5 * (hi - lo), {}, std::numeric_limits<double>::infinity()};
  }

  static std::array<Cell, 2> halves_of(const Cell& cell, int axis) {
    std::array<Cell, 2> halves{cell, cell};
    for (Cell& half : halves) half.half[axis] *= 0.5;
    halves[0].center[axis] -= halves[0].half[axis];
    halves[1].center[axis] += halves[1].half[axis];
    return halves;
  }

  // Cuts the box there; returns what both halves are above the best, together.
  double cut(const Cell& cell, int axis, std::array<Cell, 2>& halves) {
    halves = halves_of(cell, axis);
    double above_mm = 0.0;
    for (Cell& half : halves) {
      bound(half);
      above_mm += std::max(0.0, half.most_mm - known_mm());
    }
    return above_mm;
  }

  // Across the longest axis; across the best one where that hardly helps: a face or an edge asks
  // for boxes as long as it is.
  void split(const Cell& cell) {
    const std::array<int, 3> axes = longest_first(cell.half);
    std::array<Cell, 2> best, other;
    double least_mm = cut(cell, axes[0], best);
    const double hardly_mm = kHardly * 2.0 * (cell.most_mm - known_mm());
    if (cuts_any_axis_ && least_mm >= hardly_mm) {
      for (const int axis : {axes[1], axes[2]})
        if (const double above_mm = cut(cell, axis, other); above_mm < least_mm) {
          least_mm = above_mm;
          best = other;
        }
    }
    for (const Cell& half : best) push(half);
  }

  void begin() {
    Cell all = root();
    bound(all);
    open_ = {};
    push(all);
    most_mm_ = known_mm();
  }

  void push(Cell cell) {
    if (cell.most_mm <= known_mm()) return;
    cell.number = next_number_++;
    open_.push(cell);
  }

  Faces faces_of(int body, const Cell& cell, const SurfacePoint& at, double radius_mm) {
    const Pose X_SB = body == 0 ? pair_.X_KS[1] : Pose();
    SpaceBox box{X_SB * cell.center, {}};
    for (int k = 0; k < 3; ++k)
      box.half[static_cast<std::size_t>(k)] = X_SB.q * Vec3(cell.half[k] * Vec3::Unit(k));
    const Vec3 away = (box.center - at.point).stableNormalized();
    near_[body] = at.triangle;
    const SurfacePoint other = surface(body, X_SB.inverse() * (box.center + radius_mm * away));
    Faces faces{{at.triangle, other.triangle}, {}};
    for (std::size_t i = 0; i < 2; ++i)
      faces.is_below[i] =
          is_over_facet(*pair_.bodies[body].solid, faces.triangle[i], box, pair_.rounding_mm);
    return faces;
  }

  // Distances of the corners from both faces, and their means. No point in the part is deeper than
  // its distance from any face, and the mean of two such distances bounds it as well: exact between
  // two parallel faces.
  using Corners = std::array<double, 8>;
  std::array<Corners, 3> distances_mm(int body, const Faces& faces, CellCorners corners) const {
    if (body == 0)
      for (Vec3& x : corners) x = pair_.X_KS[1] * x;
    const Solid& solid = *pair_.bodies[body].solid;
    std::array<Corners, 3> distances;
    for (std::size_t k = 0; k < 2; ++k) {
      const std::uint32_t t = faces.triangle[k];
      const Vec3 a = solid.mesh().corner(t, 0), b = solid.mesh().corner(t, 1),
                 c = solid.mesh().corner(t, 2);
      for (std::size_t i = 0; i < corners.size(); ++i)
        distances[k][i] = faces.is_below[k]
                              ? std::fabs(solid.topology().normal[t].dot(corners[i] - a))
                              : (corners[i] - nearest_on_triangle(corners[i], a, b, c)).norm();
    }
    for (std::size_t i = 0; i < corners.size(); ++i)
      distances[2][i] = 0.5 * (distances[0][i] + distances[1][i]);
    return distances;
  }

  // A sum of convex functions is largest at a corner.
  double most_over(const Cell& cell) const {
    const CellCorners corners = corners_of(cell);
    const auto a = distances_mm(0, cell.faces[0], corners),
               b = distances_mm(1, cell.faces[1], corners);
    double least_mm = std::numeric_limits<double>::infinity();
    for (const Corners& of_a : a)
      for (const Corners& of_b : b) {
        double largest_mm = 0.0;
        for (std::size_t i = 0; i < of_a.size(); ++i)
          largest_mm = std::max(largest_mm, of_a[i] + of_b[i]);
        least_mm = std::min(least_mm, largest_mm);
      }
    return least_mm;
  }

  // Its middle is, and no triangle comes into it: long boxes beside a face are seen so.
  bool is_outside(int body, const Cell& cell, const SurfacePoint& at) const {
    if (at.depth_mm >= 0.0) return false;
    const Pose X_SB = body == 0 ? pair_.X_KS[1] : Pose();
    Box box;
    for (const Vec3& x : corners_of(cell)) box.add(X_SB * x);
    bool is_clear = true;
    for_each_triangle_in(pair_.bodies[body].solid->bvh(), box,
                         [&](std::uint32_t, const auto&) { return is_clear = false; });
    return is_clear;
  }

  // At most 0 where it has no point in both.
  void bound(Cell& cell) {
    const double radius_mm = cell.half.norm(), at_most_mm = std::exchange(cell.most_mm, 0.0);
    SurfacePoint at[2];
    double most_mm = 2.0 * radius_mm;
    for (int body = 0; body < 2; ++body) {
      at[body] = surface(body, cell.center);
      if (at[body].depth_mm <= -radius_mm || is_outside(body, cell, at[body])) return;
      most_mm += at[body].depth_mm;
    }
    if (at[0].depth_mm > 0.0 && at[1].depth_mm > 0.0) {
      const double before_mm = best_mm_;
      look_at(cell.center);
      if (best_mm_ > 1.05 * before_mm) climb(0.5 * radius_mm);
    }
    cell.most_mm = std::min(at_most_mm, most_mm);
    if (cell.most_mm <= known_mm()) return;
    for (int body = 0; body < 2; ++body)
      cell.faces[static_cast<std::size_t>(body)] = faces_of(body, cell, at[body], radius_mm);
    cell.most_mm = std::min(cell.most_mm, most_over(cell));
  }

  const PairFrame& pair_;
  std::uint64_t anew_at_;  ///< what is left of the work when it begins anew
  bool cuts_any_axis_ = false;
  double start_mm_;
  double growth_;  ///< share of it by which what is found must be deeper
  double narrow_;  ///< share of the depth at which its bracket is narrow enough
  double accuracy_mm_;
  double expected_mm_;
  double thin_mm_;  ///< half the least extent of the thinner part
  std::uint64_t left_;
  std::uint64_t in_vain_;  ///< work that may find nothing deeper than the start
  std::uint64_t& evaluations_;
  std::uint32_t near_[2] = {Topology::kNone, Topology::kNone};
  double best_mm_ = 0.0, most_mm_ = 0.0, in_either_mm_ = 0.0;
  Vec3 best_B_ = Vec3::Zero();
  std::priority_queue<Cell, std::vector<Cell>, LessPromising> open_;
  std::uint32_t next_number_ = 0;
};

}  // namespace

std::optional<InnerOverlap> find_inner_overlap(const PairFrame& pair, const InnerStart& start,
                                               std::uint64_t work_cap, std::uint64_t& evaluations) {
  InnerSearch search(pair, start, work_cap, evaluations);
  const Pose X_BW = pair.X_W[1].inverse();
  const bool grows =
      std::any_of(start.points_W.begin(), start.points_W.end(), [&](const Vec3& point_W) {
        return start.inside ? search.is_inside(X_BW * point_W) : search.grows_from(X_BW * point_W);
      });
  if (!grows && !start.everywhere) return std::nullopt;
  const bool proven = search.search();
  if (!proven && !search.has_grown()) return std::nullopt;
  return search.found();
}

double inner_overlap_brute_force(const PairFrame& pair, double step_mm) {
  const Box& box = pair.bodies[1].solid->bounds();
  double most_mm = 0.0;
  for (double x = box.lo.x(); x <= box.hi.x(); x += step_mm)
    for (double y = box.lo.y(); y <= box.hi.y(); y += step_mm)
      for (double z = box.lo.z(); z <= box.hi.z(); z += step_mm) {
        const Vec3 x_B(x, y, z);
        const double a_mm = -signed_distance_mm(*pair.bodies[0].solid, pair.X_KS[1] * x_B);
        const double b_mm = -signed_distance_mm(*pair.bodies[1].solid, x_B);
        if (a_mm > 0.0 && b_mm > 0.0) most_mm = std::max(most_mm, a_mm + b_mm);
      }
  return most_mm;
}

double certain_depth_inside_mm(const OverlapQuery& query, const Vec3& point_W, double depth_mm,
                               std::uint64_t work_cap, std::uint64_t& evaluations) {
  const PairFrame frame(query);
  auto inner = convex_overlap(frame, point_W, query.accuracy_mm, evaluations);
  if (!inner)
    inner = find_inner_overlap(frame, {std::span(&point_W, 1), depth_mm}, work_cap, evaluations);
  return inner ? std::max(depth_mm, inner->depth_mm.lo - frame.reach_mm(Layer::kLower)) : depth_mm;
}

}  // namespace mortise
