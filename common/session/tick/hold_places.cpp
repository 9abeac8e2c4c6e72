#include "common/session/tick/hold_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/constants.h"
#include "common/depth/body.h"
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
  FacesThere(const Body& body, std::uint32_t triangle, const Vec3& x) : body_(body), x_(x) {
    const Solid& solid = *body.solid;
    add(triangle);
    for (const std::uint32_t t : solid.topology().neighbor[triangle]) {
      if (t == Topology::kNone) continue;
      add(t);
      for (const std::uint32_t next : solid.topology().neighbor[t])
        if (next != Topology::kNone) add(next);
    }
    if (holding_.empty()) holding_.emplace_back();  // triangles without area hold nothing
  }
  bool is_smooth() const {
    return std::all_of(holding_.begin(), holding_.end(), [&](const LeastFace& face) {
      return face.normal(x_).dot(normal()) > std::cos(kSharpEdge_rad);
    });
  }
  const LeastFace& face() const { return holding_.front(); }
  Vec3 normal() const { return face().normal(x_); }
  const Vec3& place() const { return x_; }
  double depth_mm() const { return least_deep_mm_; }
  bool is_shaft_in(const FacesThere& other) const {
    const Surface *own = face().surface, *of_other = other.face().surface;
    return own != nullptr && of_other != nullptr && own->kind == SurfaceKind::kCylinder &&
           !own->inward && of_other->kind == SurfaceKind::kCylinder && of_other->inward;
  }
  /// The axis of the round face that the edge is of; null: no edge of a shaft or bore.
  const Surface* round() const {
    for (const LeastFace& face : holding_)
      if (face.surface != nullptr && face.surface->kind == SurfaceKind::kCylinder)
        return face.surface;
    return nullptr;
  }

 private:
  void add(std::uint32_t t) {
    const SurfaceBand::Face& face = body_.face(t);
    const LeastFace least{Body::surface_of(face, Layer::kLower), body_.normal(t),
                          body_.mesh->corner(t, 0), Body::offset_of(face, Layer::kLower)};
    if (least.surface == nullptr && least.plane_normal.isZero(0.0)) return;
    const double depth_mm = least.depth_mm(x_);
    if (depth_mm < least_deep_mm_ - kTogether_mm) holding_.clear();
    if (depth_mm < least_deep_mm_ + kTogether_mm) holding_.push_back(least);
    least_deep_mm_ = std::min(least_deep_mm_, depth_mm);
  }

  const Body& body_;
  Vec3 x_;
  std::vector<LeastFace> holding_;
  double least_deep_mm_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::vector<HoldPlace> hold_places(const OverlapQuery& query, const OverlapRegion& region,
                                   double accuracy_mm) {
  const Body body_a(*query.a, *query.band_a), body_b(*query.b, *query.band_b);
  const FacesThere a(body_a, region.triangle_a, query.X_WA.inverse() * region.point_W);
  const FacesThere b(body_b, region.triangle_b, query.X_WB.inverse() * region.point_W);
  const Vec3 of_a = -(query.X_WA.q * a.normal()), of_b = query.X_WB.q * b.normal();
  // Where the search was given up, what it has found counts, not what it could not rule out.
  const Interval& certain_mm = region.certain_mm;
  HoldPlace place{region.point_W, region.normal_W,
                  certain_mm.width() > accuracy_mm ? certain_mm.lo : certain_mm.hi};
  // Which of them is followed around: the one at an edge, or a shaft in its bore.
  const bool follows_b = a.is_smooth() && (!b.is_smooth() || b.is_shaft_in(a));
  const bool follows_a = b.is_smooth() && (!a.is_smooth() || a.is_shaft_in(b));
  if (!follows_a && !follows_b) {
    const Vec3& n = of_a.dot(region.normal_W) > of_b.dot(region.normal_W) ? of_a : of_b;
    if (n.dot(region.normal_W) > kAlike) place.normal_W = n;
    return {place};
  }
  place.normal_W = follows_b ? of_a : of_b;
  std::vector<HoldPlace> places{place};
  const FacesThere &smooth = follows_b ? a : b, &followed = follows_b ? b : a;
  const Surface* round = followed.round();
  if (round == nullptr) return places;
  const Pose &X_WE = follows_b ? query.X_WB : query.X_WA,
             &X_WS = follows_b ? query.X_WA : query.X_WB;
  for (int i = 1; i < kAround; ++i) {
    const Vec3 turn = 2.0 * std::numbers::pi * i / kAround * round->axis;
    const Vec3 x_E = round->point + rotation_exp(turn) * (followed.place() - round->point);
    const Vec3 x_S = X_WS.inverse() * (X_WE * x_E);
    const double depth_mm = smooth.face().depth_mm(x_S);
    const Vec3 n = X_WS.q * smooth.face().normal(x_S);
    places.push_back({X_WE * x_E, follows_b ? Vec3(-n) : n, depth_mm});
  }
  return places;
}

std::vector<HoldPlace> hold_places(const OverlapQuery& query, const CertainPlace& place,
                                   double accuracy_mm) {
  const bool of_a = place.role == 0;
  const Pose &X_WS = of_a ? query.X_WA : query.X_WB, &X_WK = of_a ? query.X_WB : query.X_WA;
  const Body body_k = of_a ? Body(*query.b, *query.band_b) : Body(*query.a, *query.band_a);
  OverlapRegion region;
  region.point_W = X_WS * place.point_S;
  const Vec3 x_K = X_WK.inverse() * region.point_W;
  const std::uint32_t other = nearest_surface(*body_k.solid, x_K).triangle;
  region.triangle_a = of_a ? place.triangle : other;
  region.triangle_b = of_a ? other : place.triangle;
  const FacesThere k(body_k, other, x_K);
  region.normal_W = (of_a ? 1.0 : -1.0) * (X_WK.q * k.normal());
  region.certain_mm = {k.depth_mm(), k.depth_mm()};
  return hold_places(query, region, accuracy_mm);
}

}  // namespace mortise
