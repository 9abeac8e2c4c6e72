#include "common/depth/patch.h"

#include <algorithm>
#include <cmath>

namespace mortise {
namespace {

// Weight of a length around a cylinder against one along it when a piece is halved: only the former
// makes it bulge.
constexpr double kAroundWeight = 8.0;

double clamp01(double x) { return std::clamp(x, 0.0, 1.0); }

Vec3 around(const Surface& surface, const Vec3& d) {
  if (surface.kind == SurfaceKind::kSphere) return d;
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

// All but the points: in frame K.
Patch shape_of(const Body& s, Layer layer, const Piece& piece, const Pose& X_KS) {
  Patch patch;
  const SurfaceBand::Face& face = s.face(piece.triangle);
  const Surface* surface = Body::surface_of(face, layer);
  const double offset = Body::offset_of(face, layer);
  const Vec3 middle = (piece.corners[0] + piece.corners[1] + piece.corners[2]) / 3.0;
  Vec3 normal_S = surface != nullptr ? surface->outward_normal(middle) : s.normal(piece.triangle);
  Vec3 center_S = middle;
  if (surface != nullptr) {
    const double width = width_around(*surface, piece);
    const double bend = surface->curvature_bound(middle);
    patch.turn_rad = width * bend;
    // Interpolation error of the map to the surface over the piece: h^2/8 over a line, r^2/2 with
    // r = h/sqrt(3) over a triangle; the margins cover the pieces' own distance from the surface.
    const bool line = surface->kind == SurfaceKind::kCylinder;
    patch.bulge_mm = (line ? 1.05 / 8.0 : 1.1 / 6.0) * bend * width * width;
    patch.bulges_outward = !surface->inward;
    center_S -= surface->signed_distance_mm(middle) * normal_S;
  }
  patch.center = X_KS * (center_S + offset * normal_S);
  patch.normal = X_KS.q * normal_S;
  const auto add_plus = [&](const Vec3& normal_K, double offset_mm) {
    if (offset_mm > 0.0) patch.plus[patch.plus_count++] = {normal_K, offset_mm};
  };
  add_plus(patch.normal, offset);
  if (s.largest_offset_mm[static_cast<int>(layer)] > 0.0) {
    const Topology& topology = s.solid->topology();
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t other = topology.neighbor[piece.triangle][k];
      if (other == Topology::kNone || !topology.edge_sharp[piece.triangle][k] ||
          topology.edge_kind[piece.triangle][k] != EdgeKind::kConvex)
        continue;
      add_plus(X_KS.q * s.normal(other), Body::offset_of(s.face(other), layer));
    }
  }
  return patch;
}

// A corner moved to the layer's surface; outward offsets are left to Patch::plus, which also covers
// the wedge between two faces at a sharp edge.
Vec3 lifted(const Body& s, Layer layer, const Piece& piece, const Vec3& corner) {
  if (layer == Layer::kMesh) return corner;
  const SurfaceBand::Face& face = s.face(piece.triangle);
  const double inward = std::min(0.0, Body::offset_of(face, layer));
  const Surface* surface = Body::surface_of(face, layer);
  if (surface == nullptr) return corner + inward * s.normal(piece.triangle);
  const Vec3 n = surface->outward_normal(corner);
  return corner + (inward - surface->signed_distance_mm(corner)) * n;
}

}  // namespace

double Patch::beyond(const Vec3& facet_normal, double facet_turn_rad) const {
  const double turn = turn_rad + facet_turn_rad;
  const double facing = -normal.dot(facet_normal);
  double sum = spread_mm + bulge_mm * clamp01((bulges_outward ? facing : -facing) + turn);
  for (int i = 0; i < plus_count; ++i)
    sum += plus[i].offset_mm * clamp01(-plus[i].normal.dot(facet_normal) + turn);
  return sum;
}

double Patch::thickness() const {
  double sum = spread_mm + bulge_mm;
  for (int i = 0; i < plus_count; ++i) sum += plus[i].offset_mm;
  return sum;
}

Patch make_patch(const Body& s, Layer layer, const Piece& piece, const Pose& X_KS) {
  Patch patch = shape_of(s, layer, piece, X_KS);
  for (const Vec3& corner : piece.corners)
    patch.points[patch.count++] = X_KS * lifted(s, layer, piece, corner);
  finish(patch);
  return patch;
}

Patch make_swept_patch(const Body& s, Layer layer, const Piece& piece, const Pose& X_KS0,
                       const Pose& X_KS1, double spread_mm, double turn_rad) {
  Patch patch = shape_of(s, layer, piece, X_KS0);
  for (const Vec3& corner : piece.corners) {
    const Vec3 x = lifted(s, layer, piece, corner);
    patch.points[patch.count++] = X_KS0 * x;
    patch.points[patch.count++] = X_KS1 * x;
  }
  patch.spread_mm = spread_mm;
  patch.turn_rad += turn_rad;
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
