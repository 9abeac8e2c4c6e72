#include "common/session/hold_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/constants.h"
#include "common/math/rotation.h"

namespace mortise {
namespace {

// Faces whose least surfaces are as deep as the least deep one up to this, mm, hold together: an
// edge of the part.
constexpr double kTogether_mm = 5e-3;
// Normals with a larger cosine say the same.
constexpr double kAlike = 0.9;
// Places around a round edge.
constexpr int kAround = 24;

Vec3 triangle_normal(const TriangleMesh& mesh, std::uint32_t t) {
  const Vec3 n =
      (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
  const double length = n.norm();
  return length > 0.0 ? Vec3(n / length) : Vec3::Zero();
}

/// The least surface of a face.
struct LeastFace {
  const Surface* surface = nullptr;  ///< null: the plane of a triangle
  Vec3 plane_normal = Vec3::Zero(), plane_point = Vec3::Zero();
  double offset_mm = 0.0;

  Vec3 normal(const Vec3& x) const {
    return surface != nullptr ? surface->outward_normal(x) : plane_normal;
  }
  double depth_mm(const Vec3& x) const {
    return offset_mm - (surface != nullptr ? surface->signed_distance_mm(x)
                                           : plane_normal.dot(x - plane_point));
  }
};

/// The faces of a part that hold off a place near one of its triangles: at a convex edge that is
/// the one below whose least surface the place is least deep; several are an edge.
class FacesThere {
 public:
  FacesThere(const Solid& solid, const SurfaceBand& band, std::uint32_t triangle, const Vec3& x)
      : solid_(solid), band_(band), x_(x) {
    add(triangle);
    for (const std::uint32_t t : solid.topology().neighbor[triangle]) {
      if (t == Topology::kNone) continue;
      add(t);
      for (const std::uint32_t next : solid.topology().neighbor[t])
        if (next != Topology::kNone) add(next);
    }
  }
  bool is_smooth() const {
    return std::all_of(holding_.begin(), holding_.end(), [&](const LeastFace& face) {
      return face.normal(x_).dot(normal()) > std::cos(kSharpEdge_rad);
    });
  }
  const LeastFace& face() const { return holding_.front(); }
  Vec3 normal() const { return face().normal(x_); }
  const Vec3& place() const { return x_; }
  /// The axis of the round face that the edge is of; null: no edge of a shaft or bore.
  const Surface* round() const {
    for (const LeastFace& face : holding_)
      if (face.surface != nullptr && face.surface->kind == SurfaceKind::kCylinder)
        return face.surface;
    return nullptr;
  }

 private:
  void add(std::uint32_t t) {
    const SurfaceBand::Face& face = band_.face_of(t);
    LeastFace least;
    least.surface = face.surface ? &*face.surface : nullptr;
    least.plane_normal = triangle_normal(solid_.mesh(), t);
    least.plane_point = solid_.mesh().corner(t, 0);
    if (least.surface == nullptr && least.plane_normal.isZero(0.0)) return;
    least.offset_mm =
        face.tolerance_mm.lo + (least.surface != nullptr ? -face.doubt_mm() : face.deviation_mm.lo);
    const double depth_mm = least.depth_mm(x_);
    if (depth_mm < least_deep_mm_ - kTogether_mm) holding_.clear();
    if (depth_mm < least_deep_mm_ + kTogether_mm) holding_.push_back(least);
    least_deep_mm_ = std::min(least_deep_mm_, depth_mm);
  }

  const Solid& solid_;
  const SurfaceBand& band_;
  Vec3 x_;
  std::vector<LeastFace> holding_;
  double least_deep_mm_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::vector<HoldPlace> hold_places(const OverlapQuery& query, const OverlapRegion& region,
                                   double accuracy_mm) {
  const FacesThere a(*query.a, *query.band_a, region.triangle_a,
                     query.X_WA.inverse() * region.point_W);
  const FacesThere b(*query.b, *query.band_b, region.triangle_b,
                     query.X_WB.inverse() * region.point_W);
  const Vec3 of_a = -(query.X_WA.q * a.normal()), of_b = query.X_WB.q * b.normal();
  // Where the search was given up, what it has found counts, not what it could not rule out.
  const Interval& certain_mm = region.certain_mm;
  HoldPlace place{region.point_W, region.normal_W,
                  certain_mm.width() > accuracy_mm ? certain_mm.lo : certain_mm.hi};
  if (a.is_smooth() == b.is_smooth()) {
    for (const Vec3& n : {of_a, of_b})
      if (n.dot(region.normal_W) > kAlike) place.normal_W = n;
    return {place};
  }
  place.normal_W = a.is_smooth() ? of_a : of_b;
  std::vector<HoldPlace> places{place};
  const FacesThere &smooth = a.is_smooth() ? a : b, &edge = a.is_smooth() ? b : a;
  const Surface* round = edge.round();
  if (round == nullptr) return places;
  const Pose &X_WE = a.is_smooth() ? query.X_WB : query.X_WA,
             &X_WS = a.is_smooth() ? query.X_WA : query.X_WB;
  for (int i = 1; i < kAround; ++i) {
    const Vec3 turn = 2.0 * 3.14159265358979323846 * i / kAround * round->axis;
    const Vec3 x_E = round->point + rotation_exp(turn) * (edge.place() - round->point);
    const Vec3 x_S = X_WS.inverse() * (X_WE * x_E);
    const double depth_mm = smooth.face().depth_mm(x_S);
    const Vec3 n = X_WS.q * smooth.face().normal(x_S);
    places.push_back({X_WE * x_E, a.is_smooth() ? Vec3(-n) : n, depth_mm});
  }
  return places;
}

}  // namespace mortise
