#include "common/depth/cells/cover_faces.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mortise {
namespace {

// Planes whose normals differ by less are parallel.
constexpr double kParallel = 1e-9;
// An edge that is drawn outwards by both of its faces comes so much farther: as far as one of 60
// degrees at least, which a mesh may hide; sharper ones are followed as far as those of plane
// faces.
constexpr double kTravelOfRound = 2.0, kMostTravelOfRound = 20.0;
// Faces whose normals have a larger cosine go on smoothly: but for less than 1.2 degrees. With a
// larger one than the second, 20 degrees, who rises from a wall may do so by less than its chords.
constexpr double kSmoothFace = 0.9998, kNearlySmoothFace = 0.94;
// Lengths that differ by less than this share of the part are one, but for rounding.
constexpr double kSameLength = 1e-9;

}  // namespace

CoverFaces::CoverFaces(const Body& body_of) : body(body_of), planes(body_of.plane_faces()) {
  same_mm = std::max(2.0 * planes.noise_mm, kSameLength * body.solid->bvh().extent_mm);
  double most = 0.0;
  for (const SurfaceBand::Face& face : body.band->faces) {
    reach_of_face_.push_back(std::max(0.0, Body::offset_range_of(face, Layer::kUpper).hi));
    most = std::max(most, reach_of_face_.back());
    recess_mm = std::max(recess_mm, -Body::offset_of(face, Layer::kLower));
  }
  travel_mm = std::max(edge_travel(most), planes.most_travel.outward_mm);
}

Vec3 CoverFaces::normal(std::uint32_t t, const Vec3& x) const {
  const Surface* s = surface(t);
  return s != nullptr ? s->outward_normal(x) : body.normal(t);
}

CoverFaces::Meeting CoverFaces::meeting_at(std::uint32_t t, const std::vector<bool>& points,
                                           const Vec3& x, const Vec3& n) const {
  const double cosine = n.dot(normal(t, x));
  if (cosine > kSmoothFace) return Meeting::kSmooth;
  if (cosine < kNearlySmoothFace) return Meeting::kTrimmed;
  for (const std::uint32_t p : mesh().triangles[t])
    if (!points[p] && n.dot(mesh().points_mm[p] - x) <= 0.0) return Meeting::kTrimmed;
  return Meeting::kRising;
}

// Of the edges of round faces, how far any comes when its faces are moved: of a convex one both
// outwards; along a hollow one, that is not nearly smooth, one outwards and the other inwards.
double CoverFaces::edge_travel(double most_mm) const {
  double travel = kTravelOfRound * most_mm;
  for (std::uint32_t t = 0; t < count(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t other = body.solid->topology().neighbor[t][k];
      if (surface(t) == nullptr || other == Topology::kNone ||
          body.face_index(other) == body.face_index(t))
        continue;
      const Vec3& x = mesh().corner(t, k);
      const Vec3 n = normal(t, x), m = normal(other, x), across = n.cross(m);
      const double cosine = n.dot(m), sine = across.norm();
      if (cosine > kNearlySmoothFace) continue;
      if (across.dot(mesh().corner(t, (k + 1) % 3) - x) > 0.0)
        travel = std::max(travel, 2.0 * most_mm / (n + m).norm());
      else
        travel = std::max(travel, (most_mm + recess_mm * std::fabs(cosine)) / sine);
    }
  return std::min(travel, kMostTravelOfRound * std::max(most_mm, recess_mm));
}

LayerOffsets CoverFaces::offsets(std::uint32_t t) const {
  return {Body::offset_of(body.face(t), Layer::kLower),
          Body::offset_of(body.face(t), Layer::kUpper)};
}

double CoverFaces::bulge_mm(std::uint32_t t) const {
  return std::max(0.0, body.face(t).deviation_mm.hi);
}

double CoverFaces::chord_mm(std::uint32_t t) const {
  const Interval& deviation = body.face(t).deviation_mm;
  return std::max(std::fabs(deviation.lo), std::fabs(deviation.hi));
}

double CoverFaces::reach_mm(std::uint32_t t, const Vec3& n) const {
  const double reach = reach_mm(t);
  if (reach == 0.0) return 0.0;
  const Surface* s = surface(t);
  if (s == nullptr) return reach * std::max(0.0, body.normal(t).dot(n));
  // Normals between those at the corners differ from them by no more than these do.
  double most = -1.0, apart = 0.0;
  const Vec3 first = s->outward_normal(mesh().corner(t, 0));
  for (int k = 0; k < 3; ++k) {
    const Vec3 normal = s->outward_normal(mesh().corner(t, k));
    most = std::max(most, normal.dot(n));
    apart = std::max(apart, (normal - first).norm());
  }
  return reach * std::clamp(most + apart, 0.0, 1.0);
}

CoverFaces::Border CoverFaces::border(const Vec3& n, double c_mm) const {
  Border border;
  border.has_face.assign(planes.faces.size(), false);
  bool found = false;
  for (std::size_t i = 0; i < planes.faces.size(); ++i) {
    const PlaneFace& face = planes.faces[i];
    // Parallel by the second rule, so the first tells the sides alone.
    if (n.dot(face.n) < 0.5 || n.cross(face.n).norm() > kParallel ||
        std::fabs(n.dot(mesh().corner(face.triangle, 0)) - c_mm) > same_mm)
      continue;
    const LayerOffsets offsets{face.offset_mm.lo, face.offset_mm.hi};
    border.offsets = found ? larger(border.offsets, offsets) : offsets;
    found = border.has_face[i] = true;
  }
  border.has_point.assign(mesh().points_mm.size(), false);
  if (!found) {
    border.offsets = {travel_mm, travel_mm};
    return border;
  }
  for (std::uint32_t t = 0; t < count(); ++t) {
    const std::uint32_t face = planes.face_of_triangle[t];
    if (face >= planes.faces.size() || !border.has_face[face]) continue;
    for (const std::uint32_t p : mesh().triangles[t]) border.has_point[p] = true;
  }
  for (std::uint32_t t = 0; t < count(); ++t) {
    const std::uint32_t face = planes.face_of_triangle[t];
    if (face < planes.faces.size() && border.has_face[face]) continue;
    const bool is_trimmed = meeting(t, border.has_point, [&](const Vec3&) -> const Vec3& {
                              return n;
                            }) == Meeting::kTrimmed;
    double farthest = -std::numeric_limits<double>::infinity();
    for (const std::uint32_t p : mesh().triangles[t]) {
      const double out = n.dot(mesh().points_mm[p]) - c_mm;
      if (out <= same_mm && !(is_trimmed && border.has_point[p] && out > -same_mm))
        farthest = std::max(farthest, out);
    }
    // Most are too far inside for their reach to any side; that towards n costs more.
    const double least = std::min(border.offsets[0], border.offsets[1]);
    if (farthest + reach_mm(t) <= least) continue;
    const double reach = reach_mm(t, n);
    for (double& offset : border.offsets) offset = std::max(offset, farthest + reach);
  }
  return border;
}

bool CoverFaces::touches(std::uint32_t t, const std::vector<bool>& points) const {
  for (const std::uint32_t p : mesh().triangles[t])
    if (points[p]) return true;
  return false;
}

void leave_beyond(std::vector<Vec3>& polygon, const Vec3& n, double c_mm,
                  std::vector<Vec3>& spare) {
  spare.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double at_p = n.dot(p) - c_mm, at_q = n.dot(q) - c_mm;
    if (at_p > 0.0) spare.push_back(p);
    if ((at_p > 0.0) != (at_q > 0.0)) spare.push_back(p + at_p / (at_p - at_q) * (q - p));
  }
  polygon.swap(spare);
}

}  // namespace mortise
