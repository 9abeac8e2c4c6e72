#include "common/depth/answer/convex_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/depth/cells/linear_program.h"
#include "common/geometry/outline.h"
#include "common/geometry/signed_distance.h"

namespace mortise {
namespace {

// Points asked. A pair of blocks needs about ten.
constexpr int kMostPoints = 60;
// Places on the way to the start: the last one is 2^-7 of it.
constexpr int kStartPlaces = 8;
// Of points this close to the surface the direction to it is rounding, mm.
constexpr double kOn_mm = 1e-9;
// Faces of a part that one program takes.
constexpr std::size_t kMostFaces = 400;
// Common points are looked for within so many radii, which no tip leaves.
constexpr double kFar = 100.0;

// What is largest: the sum of the depths in both parts, or the smaller of them.
enum class Largest { kSum, kSmaller };

// Variables: the point in frame B, about the middle of what both boxes have in common, and its
// depth in either part; of the smaller one the depth in both.
class CuttingPlanes {
 public:
  CuttingPlanes(const PairFrame& pair, Largest largest, std::uint64_t& evaluations)
      : pair_(pair),
        largest_(largest),
        evaluations_(evaluations),
        core_(core_of(pair)),
        origin_(core_.center()) {}

  // A point that is deeper in both than enough_mm, or the deepest that was seen.
  InnerOverlap run_to(double enough_mm, const Vec3& start_B) {
    best_.in_either_mm = -std::numeric_limits<double>::infinity();
    if (core_.empty()) return best_;
    LinearProgram program = program_of();
    LinearProgram::Optimum optimum;
    program.maximize(optimum);
    Vec3 x_B = start_B;
    for (int i = 0; i < kMostPoints && !(best_.in_either_mm > enough_mm); ++i) {
      bool cut = false;
      for (const LinearProgram::Row& row : planes_at(x_B)) {
        cut |= program.cuts_off(row, optimum);
        if (!program.maximize_with(row, optimum)) return best_;
      }
      if (program.upper_bound(optimum) <= enough_mm || (!cut && i > 0)) break;
      x_B = origin_ + Vec3(optimum.y[0], optimum.y[1], optimum.y[2]);
    }
    return best_;
  }

  std::optional<InnerOverlap> run(const Vec3& start_B, double accuracy_mm) {
    if (core_.empty()) return std::nullopt;
    LinearProgram program = program_of();
    LinearProgram::Optimum optimum;
    program.maximize(optimum);
    Vec3 x_B = start_B;
    for (int i = 0; i < kMostPoints; ++i) {
      bool cut = false;
      for (const LinearProgram::Row& row : planes_at(x_B)) {
        cut |= program.cuts_off(row, optimum);
        if (!program.maximize_with(row, optimum)) return std::nullopt;
      }
      most_mm_ = std::min(most_mm_, program.upper_bound(optimum));
      if (most_mm_ <= best_.depth_mm.lo + accuracy_mm || (!cut && i > 0)) break;
      x_B = origin_ + Vec3(optimum.y[0], optimum.y[1], optimum.y[2]);
    }
    if (!(best_.depth_mm.lo > 0.0)) return std::nullopt;
    stay_near(start_B);
    best_.depth_mm.hi = std::max(best_.depth_mm.lo, most_mm_) + 2.0 * pair_.rounding_mm;
    return best_;
  }

 private:
  // Many points may be as deep, of which the program names a corner. The sum of both depths is
  // concave: of those on the way to the start the last one is told, that a clash keeps its place.
  void stay_near(const Vec3& start_B) {
    const Vec3 deepest_B = pair_.X_W[1].inverse() * best_.point_W;
    const double enough_mm = best_.depth_mm.lo - pair_.rounding_mm;
    double share = 1.0;
    for (int i = 0; i < kStartPlaces; ++i, share *= 0.5) {
      best_.depth_mm.lo = enough_mm;  // what is as deep takes its place
      planes_at(deepest_B + share * (start_B - deepest_B));
      if (best_.depth_mm.lo > enough_mm) return;
    }
    planes_at(deepest_B);
  }

  static Box core_of(const PairFrame& pair) {
    const Box& a = pair.bodies[0].solid->bounds();
    Box core;
    for (int i = 0; i < 8; ++i)
      core.add(pair.X_KS[0] * Vec3((i & 1 ? a.hi : a.lo).x(), (i & 2 ? a.hi : a.lo).y(),
                                   (i & 4 ? a.hi : a.lo).z()));
    const Box& b = pair.bodies[1].solid->bounds();
    core.lo = core.lo.cwiseMax(b.lo);
    core.hi = core.hi.cwiseMin(b.hi);
    return core;
  }

  // No point of a part is farther from its surface than half its extent.
  LinearProgram program_of() const {
    const auto most_mm = [&](int body) {
      const Box& box = pair_.bodies[body].solid->bounds();
      return 0.5 * (box.hi - box.lo).minCoeff();
    };
    const Vec3 half = core_.hi - origin_;
    if (largest_ == Largest::kSmaller)
      return {4,
              {-half.x(), -half.y(), -half.z(), 0.0},
              {half.x(), half.y(), half.z(), std::min(most_mm(0), most_mm(1))},
              {0.0, 0.0, 0.0, 1.0}};
    return {5,
            {-half.x(), -half.y(), -half.z(), 0.0, 0.0},
            {half.x(), half.y(), half.z(), most_mm(0), most_mm(1)},
            {0.0, 0.0, 0.0, 1.0, 1.0}};
  }

  // Of each part the plane that supports it in the direction from the point to its surface.
  std::array<LinearProgram::Row, 2> planes_at(const Vec3& x_B) {
    std::array<LinearProgram::Row, 2> rows;
    double depth_mm[2];
    for (int body = 0; body < 2; ++body) {
      const Solid& solid = *pair_.bodies[body].solid;
      const Vec3 x = body == 0 ? Vec3(pair_.X_KS[1] * x_B) : x_B;
      const SurfacePoint at = nearest_surface(solid, x, near_[body]);
      near_[body] = at.triangle;
      ++evaluations_;
      depth_mm[body] = at.depth_mm;
      const Vec3 n = at.depth_mm < -kOn_mm ? Vec3((x - at.point).stableNormalized()) : at.outward;
      double h = n.dot(farthest_corner(solid.bvh(), solid.outline(), n));
      Vec3 n_B = n;
      if (body == 0) {
        n_B = pair_.X_KS[0].q * n;
        h += n_B.dot(pair_.X_KS[0].p);
      }
      rows[static_cast<std::size_t>(body)].g = {n_B.x(), n_B.y(), n_B.z(), 0.0, 0.0};
      rows[static_cast<std::size_t>(body)]
          .g[static_cast<std::size_t>(largest_ == Largest::kSum ? 3 + body : 3)] = 1.0;
      rows[static_cast<std::size_t>(body)].h = h - n_B.dot(origin_);
    }
    const double sum_mm = depth_mm[0] + depth_mm[1];
    const double smaller_mm = std::min(depth_mm[0], depth_mm[1]);
    if (largest_ == Largest::kSum ? sum_mm > best_.depth_mm.lo : smaller_mm > best_.in_either_mm)
      best_ = {{sum_mm, sum_mm}, pair_.X_W[1] * x_B, smaller_mm};
    return rows;
  }

  const PairFrame& pair_;
  const Largest largest_;
  std::uint64_t& evaluations_;
  Box core_;
  Vec3 origin_;
  double most_mm_ = std::numeric_limits<double>::infinity();
  std::uint32_t near_[2] = {Topology::kNone, Topology::kNone};  // to the point asked before
  InnerOverlap best_;
};

bool are_convex(const PairFrame& pair) {
  return std::all_of(std::begin(pair.bodies), std::end(pair.bodies), [&](const Body& body) {
    return body.solid->outline().convex_slack_mm <= pair.touch_mm;
  });
}

bool has_plane_faces_alone(const Body& body) {
  const PlaneFaces& planes = body.plane_faces();
  return planes.faces.size() <= kMostFaces &&
         std::none_of(planes.face_of_triangle.begin(), planes.face_of_triangle.end(),
                      [](std::uint32_t face) { return face == PlaneFaces::kNone; });
}

}  // namespace

std::optional<InnerOverlap> convex_overlap(const PairFrame& pair, const Vec3& start_W,
                                           double accuracy_mm, std::uint64_t& evaluations) {
  if (!are_convex(pair)) return std::nullopt;
  return CuttingPlanes(pair, Largest::kSum, evaluations)
      .run(pair.X_W[1].inverse() * start_W, accuracy_mm);
}

std::optional<InnerOverlap> convex_inside_both(const PairFrame& pair, const Vec3& start_W,
                                               double deeper_mm, std::uint64_t& evaluations) {
  if (!are_convex(pair)) return std::nullopt;
  const InnerOverlap found = CuttingPlanes(pair, Largest::kSmaller, evaluations)
                                 .run_to(deeper_mm, pair.X_W[1].inverse() * start_W);
  if (!(found.in_either_mm > deeper_mm)) return std::nullopt;
  return found;
}

std::optional<double> most_of_convex_layer_mm(const PairFrame& pair, Layer layer) {
  if (!are_convex(pair) || !has_plane_faces_alone(pair.bodies[0]) ||
      !has_plane_faces_alone(pair.bodies[1]))
    return std::nullopt;
  const Vec3 origin_B = pair.bodies[1].solid->bounds().center();
  const double far_mm = kFar * (pair.smaller_radius_mm() + pair.reach_mm(layer));
  const double deep_mm = pair.deepest_mm(layer);
  LinearProgram program(5, {-far_mm, -far_mm, -far_mm, 0.0, 0.0},
                        {far_mm, far_mm, far_mm, deep_mm, deep_mm}, {0.0, 0.0, 0.0, 1.0, 1.0});
  for (std::size_t body = 0; body < 2; ++body) {
    const PlaneFaces& planes = pair.bodies[body].plane_faces();
    for (const PlaneFace& face : planes.faces) {
      const Pose X_BK = body == 0 ? pair.X_KS[0] : Pose();
      const Vec3 n_B = X_BK.q * face.n;
      LinearProgram::Row row;
      row.g = {n_B.x(), n_B.y(), n_B.z(), 0.0, 0.0};
      row.g[3 + body] = 1.0;
      row.h = face.c + n_B.dot(X_BK.p - origin_B) + planes.noise_mm +
              (layer == Layer::kLower ? face.offset_mm.lo : face.offset_mm.hi);
      program.rows.push_back(row);
    }
  }
  LinearProgram::Optimum optimum;
  if (!program.maximize(optimum)) return 0.0;
  return program.upper_bound(optimum) + 2.0 * pair.rounding_mm;
}

}  // namespace mortise
