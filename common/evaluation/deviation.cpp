#include "common/evaluation/deviation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/union_find.h"
#include "common/evaluation/tolerance.h"

namespace mortise {
namespace {

// Corners of real tessellations of a bore stand up to 1.5e-4 R off the true radius (measured on
// published peg-in-hole meshes); beyond 2e-4 R a stated radius is another radius.
constexpr double kNearOfRadius = 2e-4;
// Plane faces of imported meshes are off by the rounding of the file only.
constexpr double kNearOfPlane = 2e-5;
// A facet turns by less than 120 degrees, so its normal stays within 60 of the true one; a cap
// whose rim lies on the cylinder stands at 90.
constexpr double kNormalAgrees = 0.5;
// Facets of a plane have its normal but for the rounding of the file: 2.6 degrees.
constexpr double kPlaneNormalAgrees = 0.999;
// Facets of a round are inclined to its axis as the round is, within a few degrees however coarse
// they are; the cap at the end of a chamfer, whose rim lies on the cone, is not. 12 degrees.
constexpr double kInclinationAgrees_rad = 0.21;
// A facet sixteen times as deep as the middle one is four times as wide: not of the same round.
constexpr double kDeepFacet = 16.0;
// For the measured radius: facets that plainly run around the axis.
constexpr double kRunsAround = 0.9;

struct Candidate {
  std::uint32_t triangle = 0;
  Interval corner_mm;  // signed distances of the corners
  Interval depth_mm;   // and of all its points
  double normal_agreement = 0.0;
};

double size_of(const Surface& surface, const TriangleMesh& mesh, const Candidate& c) {
  switch (surface.kind) {
    case SurfaceKind::kCylinder:
    case SurfaceKind::kSphere:
      return surface.radius_mm;
    case SurfaceKind::kTorus:
      return surface.tube_radius_mm;
    case SurfaceKind::kCone: {  // its radius where the triangle is
      double radius = 0.0;
      for (int k = 0; k < 3; ++k) {
        const Vec3 d = mesh.corner(c.triangle, k) - surface.point;
        radius = std::max(radius, (d - d.dot(surface.axis) * surface.axis).norm());
      }
      return radius;
    }
    case SurfaceKind::kPlane:
    case SurfaceKind::kUnknown:
      break;
  }
  return 0.0;
}

class Matcher {
 public:
  Matcher(const TriangleMesh& mesh, const FeatureDeclaration& declared)
      : mesh_(mesh), declared_(declared), surface_(declared.surface) {
    mesh_radius_mm_ = bounding_sphere(mesh).radius_mm;
    plane_ = surface_.kind == SurfaceKind::kPlane;
  }

  Result<FeatureMatch> run() {
    gather();
    if (near_.empty()) return not_found();
    if (!plane_)
      for (Candidate& c : near_) c.depth_mm = depth_of(c);
    FeatureMatch match;
    match.feature.name = declared_.name;
    match.feature.surface = surface_;
    match.feature.grade = plane_ ? DeviationGrade::kPlanar : DeviationGrade::kDeclaredFeature;
    if (!plane_) match.note = drop_deep_facets();
    if (const std::string beside = just_missed(); !beside.empty())
      match.note += (match.note.empty() ? "" : "; ") + beside;
    if (const std::string contradiction = contradicts(); !contradiction.empty())
      return fail(Code::kInvalidInput, contradiction);
    for (const Candidate& c : near_) {
      match.feature.triangles.push_back(c.triangle);
      match.feature.residual_mm = std::max(
          {match.feature.residual_mm, std::fabs(c.corner_mm.lo), std::fabs(c.corner_mm.hi)});
    }
    return match;
  }

 private:
  double near_mm(const Candidate& c) const {
    const double of_size =
        plane_ ? kNearOfPlane * mesh_radius_mm_ : kNearOfRadius * size_of(surface_, mesh_, c);
    return plane_ ? of_size : std::max(of_size, declared_.chord_error_mm);
  }

  bool within_extent(const Candidate& c) const {
    if (!declared_.along_mm) return true;
    const double slack_mm = near_mm(c) + 1e-9 * mesh_radius_mm_;
    for (int k = 0; k < 3; ++k) {
      const double z_mm = (mesh_.corner(c.triangle, k) - surface_.point).dot(surface_.axis);
      if (z_mm < declared_.along_mm->lo - slack_mm || z_mm > declared_.along_mm->hi + slack_mm)
        return false;
    }
    return true;
  }

  // 1. every triangle within the extent, sorted into near ones and others that run the same way
  void gather() {
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const Vec3 &a = mesh_.corner(t, 0), &b = mesh_.corner(t, 1), &c = mesh_.corner(t, 2);
      Candidate candidate;
      candidate.triangle = t;
      if (!within_extent(candidate)) continue;
      const double da = surface_.signed_distance_mm(a), db = surface_.signed_distance_mm(b),
                   dc = surface_.signed_distance_mm(c);
      candidate.corner_mm = {std::min({da, db, dc}), std::max({da, db, dc})};
      const Vec3 normal = (b - a).cross(c - a);
      const double length = normal.norm();
      if (!(length > 0.0)) continue;
      const Vec3 true_normal = surface_.outward_normal((a + b + c) / 3.0);
      if (!inclined_alike(normal / length, true_normal)) continue;
      if (surface_.is_cap(a, b, c, kNearOfRadius * size_of(surface_, mesh_, candidate))) continue;
      candidate.normal_agreement = normal.dot(true_normal) / length;
      const double near = near_mm(candidate);
      const double agrees = plane_ ? kPlaneNormalAgrees : kNormalAgrees;
      if (candidate.corner_mm.lo >= -near && candidate.corner_mm.hi <= near) {
        if (candidate.normal_agreement > agrees) near_.push_back(candidate);
        if (candidate.normal_agreement < -agrees) ++turned_;
      } else if (candidate.normal_agreement > (plane_ ? agrees : kRunsAround) &&
                 candidate.corner_mm.width() <= std::max(near, 1e-3 * size_for_text(candidate)) &&
                 std::fabs(candidate.corner_mm.middle()) <= farthest_named_mm(candidate)) {
        same_way_.push_back(candidate);
      }
    }
  }

  bool inclined_alike(const Vec3& normal, const Vec3& true_normal) const {
    if (surface_.kind != SurfaceKind::kCylinder && surface_.kind != SurfaceKind::kCone) return true;
    const auto inclination = [&](const Vec3& n) {
      return std::asin(std::clamp(std::fabs(n.dot(surface_.axis)), 0.0, 1.0));
    };
    return std::fabs(inclination(normal) - inclination(true_normal)) < kInclinationAgrees_rad;
  }

  double size_for_text(const Candidate& c) const {
    return plane_ ? mesh_radius_mm_ * 1e-3 : size_of(surface_, mesh_, c);
  }

  // Farther off, another face is meant; naming its radius would not help.
  double farthest_named_mm(const Candidate& c) const {
    return plane_ ? 2.0 * mesh_radius_mm_ : size_of(surface_, mesh_, c);
  }

  Interval depth_of(const Candidate& c) const {
    return surface_.signed_distance_range_mm(mesh_.corner(c.triangle, 0),
                                             mesh_.corner(c.triangle, 1),
                                             mesh_.corner(c.triangle, 2), 1e-6);
  }

  // 2. a flat cut with its corners on the round is not part of the round
  std::string drop_deep_facets() {
    std::vector<double> depth_mm;
    for (const Candidate& c : near_) {
      const Interval& d = c.depth_mm;
      depth_mm.push_back(std::max(std::fabs(d.lo), std::fabs(d.hi)));
    }
    std::vector<double> sorted = depth_mm;
    std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
    const double middle_mm = sorted[sorted.size() / 2];
    std::vector<Candidate> kept;
    double deepest_mm = 0.0;
    for (std::size_t i = 0; i < near_.size(); ++i) {
      if (depth_mm[i] <= kDeepFacet * middle_mm + near_mm(near_[i]))
        kept.push_back(near_[i]);
      else
        deepest_mm = std::max(deepest_mm, depth_mm[i]);
    }
    const std::size_t dropped = near_.size() - kept.size();
    near_ = std::move(kept);
    if (dropped == 0) return {};
    return std::to_string(dropped) + " triangles with corners on the surface stand up to " +
           size_text(deepest_mm) +
           " mm inside it, far more than the others; taken for a flat cut, " +
           "not for this feature";
  }

  // Triangles that look like the feature but stand a little too far off: said, since they fall to
  // the rest of the part.
  std::string just_missed() const {
    constexpr double kALittle = 10.0;  // times what counts as near; beyond, nobody meant them
    std::size_t count = 0;
    double most_mm = 0.0;
    for (const Candidate& c : same_way_) {
      const double off_mm = std::max(std::fabs(c.corner_mm.lo), std::fabs(c.corner_mm.hi));
      if (off_mm > kALittle * near_mm(c)) continue;
      ++count;
      most_mm = std::max(most_mm, off_mm);
    }
    if (count == 0) return {};
    return std::to_string(count) + " more triangles run the same way up to " + size_text(most_mm) +
           " mm off, farther than counts as near; declare a chord_error if they belong to it";
  }

  // 3. corners may stand off by the chord error, but then the facets must reach the surface
  std::string contradicts() const {
    Interval all = near_.front().depth_mm;
    Interval corners = near_.front().corner_mm;
    for (const Candidate& c : near_) {
      all = hull(all, c.depth_mm);
      corners = hull(corners, c.corner_mm);
    }
    const double slack = kNearOfRadius * size_of(surface_, mesh_, near_.front());
    if (plane_ || (all.lo <= slack && all.hi >= -slack)) return {};
    return mesh_has(corners);
  }

  // What the mesh has where the corners stand at these signed distances from the declared surface.
  std::string mesh_has(const Interval& offset) const {
    const double sign = surface_.inward ? -1.0 : 1.0;
    const auto radius = [&](double declared_mm) {
      const double least = declared_mm + std::min(sign * offset.lo, sign * offset.hi);
      const double most = declared_mm + std::max(sign * offset.lo, sign * offset.hi);
      const std::string both = size_text(0.5 * (least + most)) + " mm";
      return most - least > 1e-6 ? both + " (" + size_text(least) + " to " + size_text(most) + ")"
                                 : both;
    };
    switch (surface_.kind) {
      case SurfaceKind::kCylinder:
        return "declared radius " + size_text(surface_.radius_mm) +
               " mm, but about that axis the mesh has radius " + radius(surface_.radius_mm) +
               "; declare what the mesh has, and the size as nominal";
      case SurfaceKind::kSphere:
        return "declared radius " + size_text(surface_.radius_mm) +
               " mm, but about that centre the mesh has radius " + radius(surface_.radius_mm) +
               "; declare what the mesh has, and the size as nominal";
      case SurfaceKind::kTorus:
        return "declared tube radius " + size_text(surface_.tube_radius_mm) +
               " mm, but the mesh has tube radius " + radius(surface_.tube_radius_mm) +
               "; declare what the mesh has";
      default:
        return "the nearest face of the mesh that runs the same way stands off by " +
               size_text(offset.middle()) + " mm along its normal; correct the point";
    }
  }

  Error not_found() const {
    if (turned_ > 0)
      return fail(Code::kInvalidInput,
                  plane_
                      ? "the material lies on the other side of this plane; turn its axis round"
                      : std::string("the mesh has its material on the other side; say inward: ") +
                            (surface_.inward ? "false" : "true"));
    if (same_way_.empty())
      return fail(Code::kInvalidInput,
                  "no face of the mesh runs along this surface; check point, axis and unit");
    // The cluster of triangles that stands off least.
    const auto off = [](const Candidate& c) { return std::fabs(c.corner_mm.middle()); };
    const Candidate& nearest =
        *std::min_element(same_way_.begin(), same_way_.end(), [&](const auto& a, const auto& b) {
          return off(a) != off(b) ? off(a) < off(b) : a.triangle < b.triangle;
        });
    const double reach = std::max(nearest.corner_mm.width(), 2.0 * near_mm(nearest));
    Interval offset = nearest.corner_mm;
    for (const Candidate& c : same_way_)
      if (std::fabs(c.corner_mm.middle() - nearest.corner_mm.middle()) <= reach)
        offset = hull(offset, c.corner_mm);
    return fail(Code::kInvalidInput, mesh_has(offset));
  }

  const TriangleMesh& mesh_;
  const FeatureDeclaration& declared_;
  const Surface& surface_;
  double mesh_radius_mm_ = 0.0;
  bool plane_ = false;
  std::vector<Candidate> near_, same_way_;
  std::uint64_t turned_ = 0;
};

// Could the true surface pass smoothly over this edge? Two facets of widths up to w that meet at an
// exterior angle phi hide a sagitta of (w/2) tan(phi/4) (geometry/README.md, section 2); more than
// the declared chord error means that the edge is an edge.
bool may_be_smooth(const TriangleMesh& mesh, const Topology& topology, std::uint32_t t, int k,
                   double chord_error_mm) {
  const std::uint32_t other = topology.neighbor[t][k];
  if (other == Topology::kNone) return false;
  const auto scaled_normal = [&](std::uint32_t i) {
    return Vec3(
        (mesh.corner(i, 1) - mesh.corner(i, 0)).cross(mesh.corner(i, 2) - mesh.corner(i, 0)));
  };
  const Vec3 na = scaled_normal(t), nb = scaled_normal(other);
  const double edge_mm = (mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k)).norm();
  if (!(edge_mm > 0.0)) return true;
  // Heights of single triangles: never more than the facet's width, so that a doubt counts as
  // smooth.
  const double width_mm = std::max(na.norm(), nb.norm()) / edge_mm;
  const double angle_rad = std::atan2(na.cross(nb).norm(), na.dot(nb));
  return 0.5 * width_mm * std::tan(0.25 * angle_rad) <= chord_error_mm;
}

}  // namespace

Result<FeatureMatch> match_feature(const TriangleMesh& mesh, const FeatureDeclaration& declared) {
  return Matcher(mesh, declared).run();
}

Result<FeatureMatch> check_feature(const Solid& solid, const FeatureDeclaration& declared,
                                   std::span<const std::uint32_t> triangles) {
  const TriangleMesh& mesh = solid.mesh();
  FeatureMatch match;
  match.feature.name = declared.name;
  match.feature.surface = declared.surface;
  match.feature.triangles.assign(triangles.begin(), triangles.end());
  double allowed_mm = 0.0;
  const double of_plane_mm = kNearOfPlane * solid.sphere().radius_mm;
  for (const std::uint32_t t : triangles) {
    if (t >= mesh.triangles.size())
      return fail(Code::kMismatch, "its triangles are not those of this mesh; load the mesh again");
    for (int k = 0; k < 3; ++k)
      match.feature.residual_mm =
          std::max(match.feature.residual_mm,
                   std::fabs(declared.surface.signed_distance_mm(mesh.corner(t, k))));
    Candidate candidate;
    candidate.triangle = t;
    allowed_mm = std::max({allowed_mm, kNearOfRadius * size_of(declared.surface, mesh, candidate),
                           of_plane_mm, declared.chord_error_mm});
  }
  if (declared.surface.kind == SurfaceKind::kPlane) match.feature.grade = DeviationGrade::kPlanar;
  if (match.feature.residual_mm > allowed_mm)
    return fail(Code::kMismatch, "its triangles stand " + size_text(match.feature.residual_mm) +
                                     " mm off the surface they should stand for");
  return match;
}

std::vector<FaceShape> face_shapes(const Solid& solid, double chord_error_mm) {
  const TriangleMesh& mesh = solid.mesh();
  const Topology& topology = solid.topology();
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  // 1. flat groups
  UnionFind flat(count);
  for (std::uint32_t t = 0; t < count; ++t)
    for (int k = 0; k < 3; ++k)
      if (topology.edge_kind[t][k] == EdgeKind::kFlat && topology.neighbor[t][k] != Topology::kNone)
        flat.join(t, topology.neighbor[t][k]);
  // 2. how each group meets its neighbours
  struct Meets {
    bool convex = false, concave = false, unknown = false;
  };
  std::vector<Meets> meets(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    Meets& group = meets[flat.leader_of(t)];
    for (int k = 0; k < 3; ++k) {
      const EdgeKind kind = topology.edge_kind[t][k];
      if (kind == EdgeKind::kBoundary || kind == EdgeKind::kNonManifold) group.unknown = true;
      if (kind != EdgeKind::kConvex && kind != EdgeKind::kConcave) continue;
      if (!may_be_smooth(mesh, topology, t, k, chord_error_mm)) continue;
      (kind == EdgeKind::kConvex ? group.convex : group.concave) = true;
    }
  }
  // 3. one shape a triangle
  std::vector<FaceShape> shapes(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    const Meets& group = meets[flat.leader_of(t)];
    if (group.unknown || (group.convex && group.concave))
      shapes[t] = FaceShape::kUnknown;
    else
      shapes[t] = group.convex    ? FaceShape::kConvex
                  : group.concave ? FaceShape::kConcave
                                  : FaceShape::kPlanar;
  }
  return shapes;
}

Interval chord_deviation_mm(FaceShape shape, double chord_error_mm) {
  switch (shape) {
    case FaceShape::kPlanar:
      return {};
    case FaceShape::kConvex:
      return {0.0, chord_error_mm};
    case FaceShape::kConcave:
      return {-chord_error_mm, 0.0};
    default:
      return {-chord_error_mm, chord_error_mm};
  }
}

}  // namespace mortise
