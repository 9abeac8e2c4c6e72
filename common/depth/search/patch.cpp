#include "common/depth/search/patch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "common/base/check.h"

namespace mortise {
namespace {

// Weight of a length around a cylinder against one along it when a piece is halved: only the former
// makes it bulge.
constexpr double kAroundWeight = 8.0;

// Corners of a polygon that a patch holds at both ends of an interval.
constexpr std::size_t kMostCorners = Patch::kMost / 2;

// A direction this near to an axis, as a share, has no angle about it.
constexpr double kFlat = 1e-9;

double clamp01(double x) { return std::clamp(x, 0.0, 1.0); }

Vec3 around(const Surface& surface, const Vec3& d) {
  if (surface.kind == SurfaceKind::kSphere || surface.kind == SurfaceKind::kTorus) return d;
  return d - d.dot(surface.axis) * surface.axis;
}

// Widest extent around the axis, mm.
double width_around(const Surface& surface, const Piece& piece) {
  double width = 0.0;
  for (int k = 0; k < 3; ++k)
    width = std::max(width, around(surface, piece.corners[(k + 1) % 3] - piece.corners[k]).norm());
  return width;
}

void finish(Patch& patch) {
  patch.radius_mm = 0.0;
  for (int i = 0; i < patch.count; ++i)
    patch.radius_mm = std::max(patch.radius_mm, (patch.points[i] - patch.center).norm());
  patch.radius_mm += patch.thickness();
}

// What a sharp neighbour leaves of a face: the points that are not outside of it. Part frame.
struct Cut {
  const Surface* surface = nullptr;  // null: plane
  Vec3 normal = Vec3::Zero(), point = Vec3::Zero();
  double offset_mm = 0.0;

  double outside(const Vec3& x) const {
    return (surface != nullptr ? surface->signed_distance_mm(x) : normal.dot(x - point)) -
           offset_mm;
  }
  Vec3 outward(const Vec3& x) const {
    return surface != nullptr ? surface->outward_normal(x) : normal;
  }
};

std::vector<Cut> cuts_of(const Body& s, Layer layer, std::uint32_t triangle) {
  std::vector<Cut> cuts;
  if (layer == Layer::kMesh) return cuts;
  for (const std::uint32_t t : s.sharp_neighbours(triangle)) {
    const SurfaceBand::Face& face = s.face(t);
    const Cut cut{Body::surface_of(face, layer), s.normal(t), s.mesh->corner(t, 0),
                  Body::offset_of(face, layer)};
    if (cut.offset_mm < 0.0 || (cut.surface != nullptr && cut.surface->inward)) cuts.push_back(cut);
  }
  return cuts;
}

// The point of a cone at the height of x, in the same direction from the axis: a face that ends on
// a circle about its axis is what its triangles are mapped to. The nearest point of the cone would
// lie beyond that circle. x itself where the cone is not.
Vec3 at_height_of(const Surface& cone, const Vec3& x) {
  const double height = (x - cone.point).dot(cone.axis);
  const Vec3 across = around(cone, x - cone.point);
  const double distance = across.norm();
  if (!(height > 0.0) || !(distance > 0.0)) return x;
  return x + (height * std::tan(cone.half_angle_rad) / distance - 1.0) * across;
}

// A corner moved to the layer's surface; outward offsets are left to Patch::plus, which also covers
// the wedge between two faces at a sharp edge.
class Lift {
 public:
  Lift(const Body& s, Layer layer, std::uint32_t triangle)
      : mesh_(layer == Layer::kMesh),
        surface_(Body::surface_of(s.face(triangle), layer)),
        inward_(std::min(0.0, Body::offset_of(s.face(triangle), layer))),
        normal_(surface_ == nullptr ? s.normal(triangle) : Vec3::Zero()) {}

  Vec3 operator()(const Vec3& corner) const {
    if (mesh_) return corner;
    if (surface_ == nullptr) return corner + inward_ * normal_;
    const Vec3 x = surface_->kind == SurfaceKind::kCone ? at_height_of(*surface_, corner) : corner;
    const Vec3 n = surface_->outward_normal(x);
    return x + (inward_ - surface_->signed_distance_mm(x)) * n;
  }
  const Surface* surface() const { return surface_; }
  const Vec3& triangle_normal() const { return normal_; }  // where there is no surface

 private:
  bool mesh_;
  const Surface* surface_;
  double inward_;
  Vec3 normal_;
};

using Polygon = std::vector<Vec3>;

// Where the segment from a kept point to a cut one leaves the cut's inside, no earlier.
Vec3 crossing(const Cut& cut, Vec3 kept, Vec3 gone) {
  constexpr int kHalvings = 30;  // to 1e-9 of the segment
  for (int i = 0; i < kHalvings; ++i) {
    const Vec3 middle = 0.5 * (kept + gone);
    (cut.outside(middle) <= 0.0 ? kept : gone) = middle;
  }
  return gone;
}

// Of the material around a hollow tube a figure with all corners in the tube may still have a part:
// that is where the tube bends around it.
bool bends_around(const Cut& cut, const Polygon& polygon) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (cut.outside(a) > 0.0 && cut.outside(b) > 0.0 && cut.outside(0.5 * (a + b)) <= 0.0)
      return true;
  }
  return false;
}

// The hull of the result contains what the cut leaves. A bore's inside is round and leaves a hollow
// rim, whose hull is spanned by its ends; a shaft or a plane cuts along the tangent plane below
// each point that is outside.
Polygon cut_by(const Cut& cut, const Polygon& polygon) {
  Polygon left;
  const auto clip = [&](const Cut& by, const Polygon& from) {
    Polygon to;
    for (std::size_t i = 0; i < from.size(); ++i) {
      const Vec3 &a = from[i], &b = from[(i + 1) % from.size()];
      const bool in_a = by.outside(a) <= 0.0, in_b = by.outside(b) <= 0.0;
      if (in_a) to.push_back(a);
      if (in_a != in_b) to.push_back(in_a ? crossing(by, a, b) : crossing(by, b, a));
    }
    return to;
  };
  if (cut.surface == nullptr || cut.surface->inward) return clip(cut, polygon);
  left = polygon;
  for (const Vec3& x : polygon) {
    const double outside = cut.outside(x);
    if (outside <= 0.0) continue;
    const Vec3 n = cut.outward(x);
    left = clip({nullptr, n, x - outside * n, 0.0}, left);
  }
  return left;
}

// True: something is cut off. The hull of the result contains what the cuts leave; a cut that would
// leave more corners than a patch holds is left undone.
bool cut_polygon(std::span<const Cut> cuts, Polygon& polygon) {
  bool was_cut = false;
  for (const Cut& cut : cuts) {
    bool any = false;
    for (const Vec3& x : polygon) any |= cut.outside(x) > 0.0;
    const bool tube = cut.surface != nullptr && cut.surface->kind == SurfaceKind::kTorus;
    if (!any || (tube && (!cut.surface->inward || bends_around(cut, polygon)))) continue;
    Polygon left = cut_by(cut, polygon);
    if (left.size() > kMostCorners) continue;
    was_cut = true;
    polygon = std::move(left);
    if (polygon.empty()) break;
  }
  return was_cut;
}

// The hull over a hollow rim is wider than the face: the middle is moved back behind the cuts.
Vec3 middle_of(const Polygon& polygon, std::span<const Cut> cuts) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : polygon) middle += x;
  middle /= static_cast<double>(polygon.size());
  for (const Cut& cut : cuts) {
    const double outside = cut.outside(middle);
    if (outside > 0.0) middle -= outside * cut.outward(middle);
  }
  return middle;
}

// A cone about a shaft's own axis, moved inward, ends the shaft at one height all around.
void shorten(const Surface& shaft, double radius_mm, const Cut& cut, double& lo, double& hi) {
  constexpr double kSame = 1e-9;  // rad, and share of the radius: one axis but for rounding
  const Surface* cone = cut.surface;
  if (cone == nullptr || cone->kind != SurfaceKind::kCone || cone->inward) return;
  const double along = cone->axis.dot(shaft.axis);
  const Vec3 from = cone->point - shaft.point;
  if (cone->axis.cross(shaft.axis).norm() > kSame ||
      around(shaft, from).norm() > kSame * std::max(1.0, radius_mm))
    return;
  const double height =
      (std::cos(cone->half_angle_rad) * radius_mm - cut.offset_mm) / std::sin(cone->half_angle_rad);
  const double z = from.dot(shaft.axis) + (along > 0.0 ? height : -height);
  (along > 0.0 ? lo : hi) = along > 0.0 ? std::max(lo, z) : std::min(hi, z);
  if (lo > hi) lo = hi = z;
}

// Upper bound of the angle between directions across an axis, rad; pi from a right angle on. An arc
// is at most s + 0.571 s^3, s its sine: equal at both ends of that range.
double angle_at_most(const Vec3& a, const Vec3& b) {
  const double size = a.norm() * b.norm();
  const double sine = size > 0.0 ? a.cross(b).norm() / size : 1.0;
  if (!(a.dot(b) > 0.0)) return std::numbers::pi;
  return sine * (1.0 + 0.571 * sine * sine);
}

// Of a cone over a piece whose points are mapped at their height (at_height_of). Let a_i be the
// radii of the cone at the corners with the weights of a point, u_i their directions, V the sum of
// a_i u_i, which is in the hull, and A the sum of a_i. The point's image is A u, across the axis as
// V is. Where the mesh stands off the cone by the same share e at all corners, u is along V, and A
// - |V| <= A (1 - cos(turn / 2)). Otherwise u is off V by at most (e_most - e_least) turn / 2 over
// (1 - e_most) cos(turn / 2).
void set_curvature_of_cone(const Surface& cone, const Piece& piece, double inward_mm,
                           PieceShape& shape) {
  double radius_mm = 0.0, turn_rad = 0.0, least = 1.0, most = 0.0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 d = piece.corners[k] - cone.point, across = around(cone, d);
    const Vec3 next = around(cone, piece.corners[(k + 1) % 3] - cone.point);
    const double radius = d.dot(cone.axis) * std::tan(cone.half_angle_rad);
    radius_mm = std::max(radius_mm, radius);
    const bool apex = across.norm() <= kFlat * d.norm() || next.norm() <= kFlat * d.norm();
    if (!apex) turn_rad = std::max(turn_rad, angle_at_most(across, next));
    const double off = across.norm() > kFlat * d.norm() ? 1.0 - across.norm() / radius : 0.0;
    least = std::min(least, off);
    most = std::max(most, off);
  }
  radius_mm += inward_mm;  // the images are moved along normals that turn alike
  shape.turn_rad = turn_rad;
  shape.bulges_outward = !cone.inward;
  // More than a quarter turn, or a mesh that is off its cone by half of the radius: a near bound
  // would help nobody, and twice the radius bounds any.
  if (turn_rad > 0.5 * std::numbers::pi || most > 0.5 || least < -0.5) {
    shape.bulge_mm = shape.slip_mm = 2.0 * radius_mm;
    return;
  }
  const double cosine = std::cos(0.5 * turn_rad);
  shape.bulge_mm = radius_mm * (1.0 - cosine);
  shape.slip_mm = radius_mm * 0.5 * (most - least) * turn_rad / ((1.0 - most) * cosine);
}

// Of a torus over a piece with corners near it: across the centre circle it bends by 1 / tube
// radius, around the axis by no more than 1 / distance from the axis, on the far side outward and
// on the near side inward. Edges that run around the axis dip towards it, too.
void set_curvature_of_torus(const Surface& torus, const Piece& piece, double inward_mm,
                            PieceShape& shape) {
  constexpr double kMargin = 1.25;  // for the piece's own distance from the surface
  std::array<double, 3> out, up;
  double longest = 0.0, nearest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Vec3 d = piece.corners[k] - torus.point;
    up[k] = d.dot(torus.axis);
    out[k] = (d - up[k] * torus.axis).norm();
    nearest = std::min(nearest, out[k]);
    longest = std::max(longest, (piece.corners[(k + 1) % 3] - piece.corners[k]).norm());
  }
  shape.bulges_outward = !torus.inward;
  shape.bulges_both = true;
  // An edge between points that far from the axis comes no nearer to it than this.
  const double tube = torus.tube_radius_mm;
  const double edge2 = std::max(0.0, nearest * nearest - 0.25 * longest * longest);
  const double dip = nearest - std::sqrt(edge2);
  double across = 0.0;
  for (int k = 0; k < 3; ++k)
    across = std::max(across, std::hypot(out[(k + 1) % 3] - out[k], up[(k + 1) % 3] - up[k]));
  across += dip;
  const double closest = std::max(nearest - dip - 0.25 * across, torus.radius_mm - tube);
  if (!(closest > 0.0) || across > 2.0 * tube) {
    shape.turn_rad = std::numbers::pi;
    shape.bulge_mm = 2.0 * (torus.radius_mm + tube + inward_mm);
    return;
  }
  shape.turn_rad = kMargin * (longest / closest + across / tube);
  shape.bulge_mm = kMargin / 6.0 * (longest * longest / closest + across * across / tube) *
                   (1.0 + inward_mm / tube);
}

void set_curvature(const Surface& surface, const Piece& piece, const Vec3& middle, double inward_mm,
                   PieceShape& shape) {
  if (surface.kind == SurfaceKind::kTorus)
    return set_curvature_of_torus(surface, piece, inward_mm, shape);
  if (surface.kind == SurfaceKind::kCone)
    return set_curvature_of_cone(surface, piece, inward_mm, shape);
  const double width = width_around(surface, piece);
  const double bend = surface.curvature_bound(middle);
  shape.turn_rad = width * bend;
  // Interpolation error of the map to the surface over the piece: h^2/8 over a line, r^2/2 with
  // r = h/sqrt(3) over a triangle; the margins cover the pieces' own distance from the surface.
  const bool line = surface.kind == SurfaceKind::kCylinder;
  shape.bulge_mm = (line ? 1.05 / 8.0 : 1.1 / 6.0) * bend * width * width;
  shape.bulges_outward = !surface.inward;
}

// The surface over the piece, moved by its offset, between two circles at the heights of its
// corners.
void add_circles(const Surface& surface, double offset, const Piece& piece,
                 std::span<const Cut> cuts, PieceShape& shape) {
  if (surface.kind == SurfaceKind::kSphere) {
    shape.circles[shape.circle_count++] = {surface.point, surface.axis, 0.0,
                                           surface.radius_mm + offset};
    return;
  }
  if (surface.kind == SurfaceKind::kTorus) {
    shape.circles[shape.circle_count++] = {surface.point, surface.axis, surface.radius_mm,
                                           surface.tube_radius_mm + offset};
    return;
  }
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  for (const Vec3& x : piece.corners) {
    const double z = (x - surface.point).dot(surface.axis);
    lo = std::min(lo, z);
    hi = std::max(hi, z);
  }
  if (surface.kind == SurfaceKind::kCylinder) {
    for (const Cut& cut : cuts) shorten(surface, surface.radius_mm + offset, cut, lo, hi);
    for (const double z : {lo, hi})
      shape.circles[shape.circle_count++] = {surface.point + z * surface.axis, surface.axis,
                                             surface.radius_mm + offset};
    return;
  }
  const double sine = std::sin(surface.half_angle_rad), cosine = std::cos(surface.half_angle_rad);
  if (!(lo > 0.0)) return;  // around the apex
  for (const double z : {lo, hi})
    shape.circles[shape.circle_count++] = {surface.point + (z - offset * sine) * surface.axis,
                                           surface.axis,
                                           std::max(0.0, z * sine / cosine + offset * cosine)};
}

void add_circles(const PieceShape& shape, const Pose& X_KS, Patch& patch) {
  for (int i = 0; i < shape.circle_count; ++i) {
    const Patch::Circle& circle = shape.circles[i];
    patch.circles[patch.circle_count++] = {X_KS * circle.center, X_KS.q * circle.axis,
                                           circle.radius_mm, circle.ball_mm};
  }
}

// A hull without some of its corners would prove what is not so.
void check_corners(const PieceShape& shape) {
  MORTISE_CHECK(shape.polygon.size() <= kMostCorners, "a patch holds all corners of its piece");
}

// All of a patch but its points and circles, at a pose.
Patch placed(const PieceShape& shape, const Pose& X_KS) {
  Patch patch;
  patch.turn_rad = shape.turn_rad;
  patch.bulge_mm = shape.bulge_mm;
  patch.slip_mm = shape.slip_mm;
  patch.spread_mm = shape.spread_mm;
  patch.bulges_outward = shape.bulges_outward;
  patch.bulges_both = shape.bulges_both;
  patch.center = X_KS * shape.center;
  patch.normal = X_KS.q * shape.normal;
  patch.plus_count = shape.plus_count;
  patch.plus_is_own = shape.plus_is_own;
  for (int i = 0; i < shape.plus_count; ++i)
    patch.plus[i] = {X_KS.q * shape.plus[i].normal, shape.plus[i].offset_mm, shape.plus[i].flat};
  if (shape.on_cylinder) patch.axis = X_KS.q * shape.axis;
  if (shape.on_cone) patch.cone_axis = X_KS.q * shape.axis;
  return patch;
}

}  // namespace

PieceShape shape_of(const Body& s, Layer layer, const Piece& piece) {
  PieceShape shape;
  const SurfaceBand::Face& face = s.face(piece.triangle);
  const Lift lifted(s, layer, piece.triangle);
  const Surface* surface = lifted.surface();
  const double offset = Body::offset_of(face, layer);
  Vec3 middle = (piece.corners[0] + piece.corners[1] + piece.corners[2]) / 3.0;
  shape.polygon.reserve(2 * piece.corners.size());
  for (const Vec3& corner : piece.corners) shape.polygon.push_back(lifted(corner));
  const std::vector<Cut> cuts = cuts_of(s, layer, piece.triangle);
  const bool was_cut = cut_polygon(cuts, shape.polygon);
  if (shape.polygon.empty()) return shape;
  if (was_cut) middle = middle_of(shape.polygon, cuts);
  shape.normal = surface != nullptr ? surface->outward_normal(middle) : lifted.triangle_normal();
  if (surface != nullptr) set_curvature(*surface, piece, middle, std::max(0.0, -offset), shape);
  shape.center = (was_cut && surface == nullptr ? middle : lifted(middle)) +
                 std::max(0.0, offset) * shape.normal;
  const auto add_plus = [&](const Vec3& normal, double offset_mm, bool flat) {
    if (offset_mm > 0.0) shape.plus[shape.plus_count++] = {normal, offset_mm, flat};
  };
  add_plus(shape.normal, offset, surface == nullptr);
  shape.plus_is_own = shape.plus_count > 0;
  if (surface != nullptr) {
    shape.on_cylinder = surface->kind == SurfaceKind::kCylinder;
    shape.on_cone = surface->kind == SurfaceKind::kCone;
    shape.axis = surface->axis;
  }
  if (s.largest_offset_mm[static_cast<int>(layer)] > 0.0) {
    for (const std::uint32_t t : s.sharp_neighbours(piece.triangle))
      add_plus(s.normal(t), Body::offset_of(s.face(t), layer),
               Body::surface_of(s.face(t), layer) == nullptr);
    // Of those that are left out neither offset nor direction is known.
    shape.spread_mm =
        s.sharp_left_out(piece.triangle) * s.largest_offset_mm[static_cast<int>(layer)];
  }
  if (surface != nullptr && !surface->inward) add_circles(*surface, offset, piece, cuts, shape);
  return shape;
}

double Patch::Circle::reach_mm(const Vec3& along) const {
  const double off = along.dot(axis);
  return ball_mm + radius_mm * std::sqrt(std::max(0.0, 1.0 - off * off));
}

double Patch::across(const Vec3& facet_normal, double facet_turn_rad) const {
  if (axis.isZero(0.0)) return 1.0;
  const double along = facet_normal.dot(axis);
  return clamp01(std::sqrt(std::max(0.0, 1.0 - along * along)) + motion_turn_rad + facet_turn_rad);
}

double Patch::neighbours_beyond(const Vec3& facet_normal, double facet_turn_rad) const {
  double sum = 0.0;
  for (int i = plus_is_own ? 1 : 0; i < plus_count; ++i)
    sum +=
        plus[i].offset_mm * clamp01(-plus[i].normal.dot(facet_normal) +
                                    (plus[i].flat ? motion_turn_rad : turn_rad) + facet_turn_rad);
  return sum;
}

double Patch::bulge_beyond(const Vec3& facet_normal, double facet_turn_rad) const {
  const bool cone = !cone_axis.isZero(0.0);
  const double along = cone ? facet_normal.dot(cone_axis) : 0.0;
  const double most = cone ? clamp01(std::sqrt(std::max(0.0, 1.0 - along * along)) +
                                     motion_turn_rad + facet_turn_rad)
                           : across(facet_normal, facet_turn_rad);
  const Vec3 bulging =
      cone ? Vec3((normal - normal.dot(cone_axis) * cone_axis).stableNormalized()) : normal;
  const double along_facet = bulging.dot(facet_normal);
  const double facing =
      bulges_both ? std::fabs(along_facet) : (bulges_outward ? -along_facet : along_facet);
  return bulge_mm * std::min(most, clamp01(facing + turn_rad + facet_turn_rad)) + slip_mm * most;
}

double Patch::beyond(const Vec3& facet_normal, double facet_turn_rad) const {
  const double turn = turn_rad + facet_turn_rad;
  const double most = across(facet_normal, facet_turn_rad);
  double sum = spread_mm + neighbours_beyond(facet_normal, facet_turn_rad) +
               bulge_beyond(facet_normal, facet_turn_rad);
  if (plus_is_own)
    sum += plus[0].offset_mm * std::min(most, clamp01(-plus[0].normal.dot(facet_normal) + turn));
  return sum;
}

double Patch::depth_below_plane(const Vec3& facet_normal, const Vec3& point,
                                double facet_turn_rad) const {
  double by_points = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < count; ++i)
    by_points = std::max(by_points, -facet_normal.dot(points[i] - point));
  const double more = beyond(facet_normal, facet_turn_rad);
  if (circle_count == 0) return by_points + more;
  double by_circles = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < circle_count; ++i) {
    const Circle& circle = circles[i];
    by_circles = std::max(by_circles,
                          circle.reach_mm(facet_normal) - facet_normal.dot(circle.center - point));
  }
  // The hull of the points bulges; the circles do not.
  const double outward = spread_mm + neighbours_beyond(facet_normal, facet_turn_rad);
  return std::min(by_points + more, by_circles + outward);
}

double Patch::thickness() const {
  double sum = spread_mm + bulge_mm + slip_mm;
  for (int i = 0; i < plus_count; ++i) sum += plus[i].offset_mm;
  return sum;
}

Vec3 on_layer(const Body& s, Layer layer, std::uint32_t triangle, const Vec3& x) {
  if (layer == Layer::kMesh) return x;
  const Lift lifted(s, layer, triangle);
  Vec3 y = lifted(x);
  for (const Cut& cut : cuts_of(s, layer, triangle)) {
    const double outside = cut.outside(y);
    if (outside > 0.0) y -= outside * cut.outward(y);
  }
  const Vec3 n =
      lifted.surface() != nullptr ? lifted.surface()->outward_normal(y) : lifted.triangle_normal();
  return y + std::max(0.0, Body::offset_of(s.face(triangle), layer)) * n;
}

Patch make_patch(const PieceShape& shape, const Pose& X_KS) {
  Patch patch = placed(shape, X_KS);
  check_corners(shape);
  for (const Vec3& x : shape.polygon) patch.points[patch.count++] = X_KS * x;
  add_circles(shape, X_KS, patch);
  finish(patch);
  return patch;
}

Patch make_patch(const Body& s, Layer layer, const Piece& piece, const Pose& X_KS) {
  return make_patch(shape_of(s, layer, piece), X_KS);
}

Patch make_swept_patch(const PieceShape& shape, const Pose& X_KS0, const Pose& X_KS1,
                       double spread_mm, double turn_rad) {
  Patch patch = placed(shape, X_KS0);
  check_corners(shape);
  for (const Vec3& x : shape.polygon) {
    patch.points[patch.count++] = X_KS0 * x;
    patch.points[patch.count++] = X_KS1 * x;
  }
  add_circles(shape, X_KS0, patch);
  add_circles(shape, X_KS1, patch);
  patch.spread_mm += spread_mm;
  patch.turn_rad += turn_rad;
  patch.motion_turn_rad = turn_rad;
  finish(patch);
  return patch;
}

std::array<Piece, 2> split(const Body& s, Layer layer, const Piece& piece) {
  const Surface* surface = Body::surface_of(s.face(piece.triangle), layer);
  int longest = 0;
  double largest = -1.0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 d = piece.corners[(k + 1) % 3] - piece.corners[k];
    double size = d.squaredNorm();
    if (surface != nullptr)
      size += (kAroundWeight * kAroundWeight - 1.0) * around(*surface, d).squaredNorm();
    if (size > largest) {
      largest = size;
      longest = k;
    }
  }
  const int next = (longest + 1) % 3;
  const Vec3 middle = 0.5 * (piece.corners[longest] + piece.corners[next]);
  std::array<Piece, 2> halves = {piece, piece};
  halves[0].corners[next] = middle;
  halves[1].corners[longest] = middle;
  return halves;
}

}  // namespace mortise
