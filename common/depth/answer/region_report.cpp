#include "common/depth/answer/region_report.h"

#include <algorithm>
#include <cmath>

#include "common/depth/answer/plane_pair.h"
#include "common/depth/search/convex_edge.h"
#include "common/depth/triangles_in.h"

namespace mortise {
namespace {

// Unit vectors that differ by less are one.
constexpr double kSameNormal = 1e-9;

// Triangles that are asked whether they lie on a face of the other part that looks the same way.
constexpr std::size_t kMostCoincidenceQuestions = 64;
// Triangles of a part below which its twin is looked for.
constexpr std::uint32_t kTwinQuestions = 24;

// Two normals look the same way.
constexpr double kSameWay = 0.99;

// Steps to a point inside both parts, as shares of the overlap: a part may be far thinner than the
// overlap is deep.
constexpr double kWitnessShares[] = {0.5, 0.25, 0.1, 0.02, 2e-3, 2e-4, 2e-5, 2e-6};

// From a facet to its surface it is longer along the facet's normal than straight, by less than
// this.
constexpr double kOblique = 1.1;

// Steps uphill to a witness start at so many times the overlap and are halved so many times, down
// to a 4096th of it.
constexpr double kFirstClimb = 8.0;
constexpr int kWitnessHalvings = 16;

double distance_from_axis(const Surface& surface, const Vec3& x) {
  const Vec3 d = x - surface.point;
  return (d - d.dot(surface.axis) * surface.axis).norm();
}

// Depth of x in the least real part.
double least_depth(const Body& body, const Vec3& x) {
  return body.depth_in(x, nearest_surface(*body.solid, x), Layer::kLower);
}

// Walks to the point that lies deepest in both.
class Climb {
 public:
  Climb(const PairFrame& pair, int role, const Vec3& start_K, std::uint64_t& evaluations)
      : pair_(pair), role_(role), evaluations_(evaluations), x_K_(start_K) {
    const double in_k = depth_in_k(start_K), in_s = depth_in_s(start_K);
    s_is_least_ = in_s < in_k;
    depth_mm_ = std::min(in_k, in_s);
  }
  // Goes there when it is deeper; true: inside both, beyond rounding. Asked first of the part in
  // which the last point lay less deep: mostly that says no.
  bool better(const Vec3& to_K) {
    const double first = s_is_least_ ? depth_in_s(to_K) : depth_in_k(to_K);
    if (!(first > depth_mm_)) return false;
    const double second = s_is_least_ ? depth_in_k(to_K) : depth_in_s(to_K);
    if (!(second > depth_mm_)) return false;
    s_is_least_ = s_is_least_ == (first < second);
    depth_mm_ = std::min(first, second);
    x_K_ = to_K;
    return depth_mm_ > pair_.rounding_mm;
  }
  const Vec3& at_K() const { return x_K_; }
  Vec3 at_W() const { return pair_.in_world(role_, x_K_); }

 private:
  double depth_in_k(const Vec3& x_K) {
    ++evaluations_;
    return least_depth(pair_.k(role_), x_K);
  }
  double depth_in_s(const Vec3& x_K) {
    ++evaluations_;
    return least_depth(pair_.s(role_), pair_.X_KS[1 - role_] * x_K);
  }

  const PairFrame& pair_;
  int role_;
  std::uint64_t& evaluations_;
  Vec3 x_K_;
  double depth_mm_;
  bool s_is_least_;
};

}  // namespace

FaceShape face_shape(const Body& body, std::uint32_t triangle, const Vec3& x) {
  const SurfaceBand::Face& face = body.face(triangle);
  if (face.surface) switch (face.surface->kind) {
      case SurfaceKind::kPlane:
        return FaceShape::kPlanar;
      case SurfaceKind::kTorus:
        if (distance_from_axis(*face.surface, x) < face.surface->radius_mm)
          return FaceShape::kSaddle;
        return face.surface->inward ? FaceShape::kConcave : FaceShape::kConvex;
      case SurfaceKind::kCylinder:
      case SurfaceKind::kCone:
      case SurfaceKind::kSphere:
        return face.surface->inward ? FaceShape::kConcave : FaceShape::kConvex;
      case SurfaceKind::kUnknown:
        break;
    }
  const Topology& topology = body.solid->topology();
  bool convex = false, concave = false;
  // The triangle and those that share its plane.
  std::array<std::uint32_t, 4> group = {triangle, Topology::kNone, Topology::kNone,
                                        Topology::kNone};
  for (int k = 0; k < 3; ++k)
    if (topology.edge_kind[triangle][k] == EdgeKind::kFlat)
      group[1 + k] = topology.neighbor[triangle][k];
  for (const std::uint32_t t : group) {
    if (t == Topology::kNone) continue;
    for (int k = 0; k < 3; ++k) {
      if (topology.edge_sharp[t][k]) continue;
      convex |= topology.edge_kind[t][k] == EdgeKind::kConvex;
      concave |= topology.edge_kind[t][k] == EdgeKind::kConcave;
    }
  }
  if (convex && concave) return FaceShape::kSaddle;
  if (convex) return FaceShape::kConvex;
  return concave ? FaceShape::kConcave : FaceShape::kPlanar;
}

bool is_borne_out(const Body& body, const Vec3& x, double rounding_mm) {
  if (inside(*body.solid, x)) return true;
  const Vec3 at = nearest_point(*body.solid, x).point;
  bool any = false, within = true;
  for_each_triangle_in(
      body.solid->bvh(), Box{at.array() - rounding_mm, at.array() + rounding_mm},
      [&](std::uint32_t t, const std::array<Vec3, 3>& c) {
        if ((nearest_on_triangle(at, c[0], c[1], c[2]) - at).norm() > rounding_mm) return;
        const double stated_mm = std::max(0.0, body.offset_at(t, at, Layer::kLower));
        const double above_mm = body.normal(t).dot(x - at);
        const SurfaceBand::Face& face = body.face(t);
        const Surface* surface = Body::surface_of(face, Layer::kLower);
        // Off the middle of a facet its normal is not that of the surface.
        const bool below = surface != nullptr && above_mm <= kOblique * stated_mm &&
                           surface->signed_distance_mm(x) <= Body::offset_of(face, Layer::kLower);
        any = true;
        within &= below || above_mm <= stated_mm + rounding_mm;
      });
  return any && within;
}

namespace {

std::optional<Vec3> find_inside(const PairFrame& pair, const Sample& least,
                                std::uint64_t& evaluations, std::uint64_t* refused) {
  const int role = least.role;
  const Vec3& p = least.point_K;
  Vec3 out = least.at.outward;
  const Vec3 to_surface = least.at.point - p;
  const double distance = to_surface.norm();
  if (distance > std::max(pair.rounding_mm, 1e-3 * least.depth_mm))
    out = (least.at.depth_mm > 0.0 ? 1.0 : -1.0) * to_surface / distance;
  const Vec3 into_s = -(pair.X_KS[role].q * pair.s(role).normal(least.triangle));
  // At a corner or edge of S a move along a face normal stays on the next face; from the middle of
  // the triangle it goes inside.
  const TriangleMesh& mesh_s = *pair.s(role).mesh;
  const Vec3 middle_K =
      pair.X_KS[role] * Vec3((mesh_s.corner(least.triangle, 0) + mesh_s.corner(least.triangle, 1) +
                              mesh_s.corner(least.triangle, 2)) /
                             3.0);
  const Vec3 inwards = ((middle_K - p).stableNormalized() + into_s).stableNormalized();
  Climb climb(pair, role, p, evaluations);
  const auto found_at = [&](const Vec3& to_K) {
    if (!climb.better(to_K)) return false;
    const auto is_in = [&](const Body& body, const Vec3& x) {
      return is_borne_out(body, x, pair.rounding_mm) &&
             !is_past_convex_edge(body, x, pair.rounding_mm);
    };
    const bool good = is_in(pair.k(role), climb.at_K()) &&
                      is_in(pair.s(role), pair.X_KS[1 - role] * climb.at_K());
    if (!good && refused != nullptr) ++*refused;
    return good;
  };
  for (const double share : kWitnessShares)
    for (const Vec3& along : {out, into_s, Vec3((out + into_s).stableNormalized()), inwards,
                              Vec3((out + inwards).stableNormalized())})
      if (found_at(p + share * least.depth_mm * along)) return climb.at_W();
  // Near an edge there may be room in no one of these directions: uphill from the best of them,
  // along the wall of K to the middle of the triangle, across, and off the wall.
  const Vec3 to_middle = middle_K - p;
  const Vec3 u = Vec3(to_middle - to_middle.dot(out) * out).stableNormalized();
  const Vec3 v = out.cross(u);
  double step_mm = kFirstClimb * least.depth_mm;
  for (int i = 0; i < kWitnessHalvings; ++i, step_mm *= 0.5)
    for (const Vec3& along : {out, Vec3(-out), u, Vec3(-u), v, Vec3(-v), inwards})
      if (found_at(climb.at_K() + step_mm * along)) return climb.at_W();
  return std::nullopt;
}

}  // namespace

// Depth by triangles knows no neighbour that cuts a face short; the sharp bodies do.
std::optional<Vec3> find_witness(const PairFrame& pair, const Sample& least,
                                 std::uint64_t& evaluations, std::uint64_t* refused) {
  const std::optional<Vec3> found = find_inside(pair, least, evaluations, refused);
  return found && is_outside_of_least_bodies(pair, *found) ? std::nullopt : found;
}

namespace {

// Below a triangle of A, by shares of its size, the largest first.
std::optional<SharedInside> shared_below(const PairFrame& pair, std::uint32_t t,
                                         std::uint32_t triangle_b, std::uint64_t& evaluations) {
  const Body& a = pair.bodies[0];
  const Vec3 x_A = (a.mesh->corner(t, 0) + a.mesh->corner(t, 1) + a.mesh->corner(t, 2)) / 3.0;
  const double size = (a.mesh->corner(t, 1) - a.mesh->corner(t, 0)).norm();
  for (const double share : {1.0, 0.3, 0.1, 0.03, 0.01}) {
    const Vec3 w_A = x_A - share * size * a.normal(t);
    const double depth_a = nearest_surface(*a.solid, w_A).depth_mm;
    const double depth_b = nearest_surface(*pair.bodies[1].solid, pair.X_KS[0] * w_A).depth_mm;
    evaluations += 2;
    if (depth_a > pair.touch_mm && depth_b > pair.touch_mm)
      return SharedInside{
          pair.X_W[0] * w_A, depth_a + depth_b, std::min(depth_a, depth_b), {t, triangle_b}};
  }
  return std::nullopt;
}

}  // namespace

std::optional<SharedInside> find_shared_inside(const PairFrame& pair,
                                               const Candidates& candidates) {
  const Body& a = pair.bodies[0];
  const Body& b = pair.bodies[1];
  if (!a.has_inside || !b.has_inside) return std::nullopt;
  const std::vector<std::uint32_t>& triangles = candidates.triangles[0];
  const std::size_t step = std::max<std::size_t>(1, triangles.size() / kMostCoincidenceQuestions);
  std::uint64_t evaluations = 0;
  for (std::size_t i = 0; i < triangles.size(); i += step) {
    const std::uint32_t t = triangles[i];
    const Vec3 x_A = (a.mesh->corner(t, 0) + a.mesh->corner(t, 1) + a.mesh->corner(t, 2)) / 3.0;
    const SurfacePoint at = nearest_surface(*b.solid, pair.X_KS[0] * x_A);
    if (std::fabs(at.depth_mm) > pair.touch_mm) continue;
    if ((pair.X_KS[0].q * a.normal(t)).dot(at.face_normal) < kSameWay) continue;
    if (auto shared = shared_below(pair, t, at.triangle, evaluations)) return shared;
  }
  return std::nullopt;
}

std::optional<SharedInside> find_inside_of_twins(const PairFrame& pair,
                                                 std::uint64_t& evaluations) {
  const Body& a = pair.bodies[0];
  if (!a.has_inside) return std::nullopt;
  const auto count = static_cast<std::uint32_t>(a.mesh->triangles.size());
  const std::uint32_t step = std::max<std::uint32_t>(1, count / kTwinQuestions);
  std::optional<SharedInside> deepest;
  for (std::uint32_t t = 0; t < count; t += step)
    if (const auto shared = shared_below(pair, t, t, evaluations);
        shared && !(deepest && deepest->depth_mm >= shared->depth_mm))
      deepest = shared;
  return deepest;
}

std::optional<SharedInside> find_middle_in_both(const PairFrame& pair, double least_mm,
                                                std::uint64_t& evaluations) {
  std::optional<SharedInside> deepest;
  if (!pair.has_insides()) return deepest;
  for (const int own : {0, 1}) {
    const Vec3 x_W = pair.X_W[own] * pair.bodies[own].solid->sphere().center_mm;
    SharedInside shared{x_W, 0.0, std::numeric_limits<double>::infinity(), {0, 0}};
    // The other part first: parts that only touch are told apart by it, and from the middle of a
    // ball each of its triangles is as near.
    for (const int i : {1 - own, own}) {
      const SurfacePoint at = nearest_surface(*pair.bodies[i].solid, pair.X_W[i].inverse() * x_W);
      ++evaluations;
      shared.depth_mm += at.depth_mm;
      shared.in_either_mm = std::min(shared.in_either_mm, at.depth_mm);
      shared.triangle[i] = at.triangle;
      if (shared.in_either_mm < least_mm) break;
    }
    if (shared.in_either_mm >= least_mm && !(deepest && deepest->depth_mm >= shared.depth_mm))
      deepest = shared;
  }
  return deepest;
}

OverlapRegion region_of_certain(const PairFrame& pair, const Sample& deepest, double most_mm) {
  OverlapRegion region;
  region.certain_mm = {deepest.depth_mm, std::max(deepest.depth_mm, most_mm)};
  region.possible_mm = {region.certain_mm.lo, kInfinity};
  region.delta_mm = {-kInfinity, kInfinity};
  describe(pair, deepest, deepest, region);
  return region;
}

void set_shapes(const PairFrame& pair, OverlapRegion& region) {
  region.shape_a =
      face_shape(pair.bodies[0], region.triangle_a, pair.X_W[0].inverse() * region.point_W);
  region.shape_b =
      face_shape(pair.bodies[1], region.triangle_b, pair.X_W[1].inverse() * region.point_W);
}

void set_witness(const PairFrame& pair, const std::optional<Vec3>& witness_W, const Sample& from,
                 OverlapRegion& region) {
  region.has_witness = witness_W.has_value();
  if (!witness_W) return;
  region.witness_W = *witness_W;
  region.certain_place = {from.role, from.triangle, pair.X_KS[1 - from.role] * from.point_K};
}

void describe(const PairFrame& pair, const Sample& deepest, const Sample& deciding,
              OverlapRegion& region) {
  const int role = deepest.role;
  region.point_W = pair.in_world(role, deepest.point_K);
  const Vec3 to_surface = deepest.at.point - deepest.point_K;
  const double distance = to_surface.norm();
  Vec3 out = deepest.at.outward;
  if (distance > pair.touch_mm)
    out = (deepest.at.depth_mm > 0.0 ? 1.0 : -1.0) * to_surface / distance;
  // Above the inside of a facet that is its normal, whichever point was the deepest that was asked.
  if ((out - deepest.at.face_normal).norm() < kSameNormal) out = deepest.at.face_normal;
  // Role 0: out of B. Role 1: out of A, that is from A to B.
  region.normal_W = (role == 0 ? 1.0 : -1.0) * (pair.X_W[1 - role].q * out);
  region.triangle_a = role == 0 ? deepest.triangle : deepest.at.triangle;
  region.triangle_b = role == 0 ? deepest.at.triangle : deepest.triangle;
  region.deciding_triangle_a = deciding.role == 0 ? deciding.triangle : deciding.at.triangle;
  region.deciding_triangle_b = deciding.role == 0 ? deciding.at.triangle : deciding.triangle;
  const Vec3 at_W = pair.in_world(deciding.role, deciding.point_K);
  region.shape_a =
      face_shape(pair.bodies[0], region.deciding_triangle_a, pair.X_W[0].inverse() * at_W);
  region.shape_b =
      face_shape(pair.bodies[1], region.deciding_triangle_b, pair.X_W[1].inverse() * at_W);
}

Interval without_touch(Interval value, double touch_mm) {
  if (value.hi <= touch_mm) value.hi = std::min(value.hi, 0.0);
  if (value.lo <= touch_mm) value.lo = std::min(value.lo, 0.0);
  return {std::min(value.lo, value.hi), value.hi};
}

}  // namespace mortise
