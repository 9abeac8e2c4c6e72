#include "common/geometry/plane_faces.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/constants.h"
#include "common/geometry/across_material.h"

namespace mortise {
namespace {

// Corners of one face lie in one plane within so many roundings of single precision, in which most
// meshes are written.
constexpr double kFlatRoundings = 8.0 / 16777216.0;
// Facets of one face look the same way.
constexpr double kLeastAlong = 0.9;
// More faces in one corner: their travel is not worked out.
constexpr std::size_t kMostFacesOfCorner = 12;
// Three planes whose normals span less have no corner of their own.
constexpr double kLeastSpan = 1e-9;

double largest_coordinate(const TriangleMesh& mesh) {
  double largest = 0.0;
  for (const Vec3& p : mesh.points_mm) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  return largest;
}

Vec3 twice_area_of(const TriangleMesh& mesh, std::uint32_t t) {
  return (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
}

class Merge {
 public:
  Merge(const Solid& solid, const SurfaceBand& band)
      : mesh_(solid.mesh()), topology_(solid.topology()), band_(band) {
    flat_mm_ = kFlatRoundings * largest_coordinate(mesh_);
  }

  PlaneFaces run() {
    const auto count = static_cast<std::uint32_t>(mesh_.triangles.size());
    result_.face_of_triangle.assign(count, PlaneFaces::kNone);
    // The largest facet of a face knows its plane best.
    std::vector<std::pair<double, std::uint32_t>> by_area;
    for (std::uint32_t t = 0; t < count; ++t)
      if (is_plane_band(band_, band_.face_of(t)))
        by_area.push_back({-twice_area_of(mesh_, t).norm(), t});
    std::sort(by_area.begin(), by_area.end());
    for (const auto& [area, t] : by_area) {
      if (result_.face_of_triangle[t] != PlaneFaces::kNone) continue;
      if (area < 0.0)
        grow(t, -area);
      else
        result_.face_of_triangle[t] = PlaneFaces::kWithoutArea;
    }
    return std::move(result_);
  }

 private:
  void grow(std::uint32_t seed, double twice_area) {
    const auto index = static_cast<std::uint32_t>(result_.faces.size());
    PlaneFace face;
    face.n = twice_area_of(mesh_, seed) / twice_area;
    face.c = face.n.dot(mesh_.corner(seed, 0));
    face.triangle = seed;
    const SurfaceBand::Face& band = band_.face_of(seed);
    face.offset_mm = band.deviation_mm + band.tolerance_mm;
    result_.face_of_triangle[seed] = index;
    stack_.assign(1, seed);
    while (!stack_.empty()) {
      const std::uint32_t t = stack_.back();
      stack_.pop_back();
      for (int k = 0; k < 3; ++k)
        result_.noise_mm =
            std::max(result_.noise_mm, std::fabs(face.n.dot(mesh_.corner(t, k)) - face.c));
      for (const std::uint32_t other : topology_.neighbor[t]) {
        if (other == Topology::kNone || !belongs(face, other)) continue;
        result_.face_of_triangle[other] = index;
        stack_.push_back(other);
      }
    }
    result_.faces.push_back(face);
  }

  bool belongs(const PlaneFace& face, std::uint32_t t) const {
    if (result_.face_of_triangle[t] != PlaneFaces::kNone) return false;
    const SurfaceBand::Face& band = band_.face_of(t);
    if (!is_plane_band(band_, band) || !(band.deviation_mm + band.tolerance_mm == face.offset_mm))
      return false;
    for (int k = 0; k < 3; ++k)
      if (std::fabs(face.n.dot(mesh_.corner(t, k)) - face.c) > flat_mm_) return false;
    const Vec3 area = twice_area_of(mesh_, t);
    return area.dot(face.n) >= kLeastAlong * area.norm();
  }

  const TriangleMesh& mesh_;
  const Topology& topology_;
  const SurfaceBand& band_;
  double flat_mm_ = 0.0;
  PlaneFaces result_;
  std::vector<std::uint32_t> stack_;
};

// Least move that carries a point from two planes, or three, to their offset ones, as a sum of
// their normals. Only where no normal counts negatively does the point come out of the cone.
struct Move {
  double length_mm = 0.0;
  bool outwards = false;
};

Move move_of(const Vec3& n, double o, const Vec3& m, double p) {
  const double cosine = n.dot(m), span = 1.0 - cosine * cosine;
  if (span < kLeastSpan) return {cosine > 0.0 && o == p ? std::fabs(o) : kInfinity, o > 0.0};
  const double of_n = o - cosine * p, of_m = p - cosine * o;
  return {((of_n * n + of_m * m) / span).norm(), of_n >= 0.0 && of_m >= 0.0};
}

Move move_of(const std::array<Vec3, 3>& n, const std::array<double, 3>& o) {
  const std::array<Vec3, 3> across = {n[1].cross(n[2]), n[2].cross(n[0]), n[0].cross(n[1])};
  const double span = n[0].dot(across[0]);
  if (std::fabs(span) < kLeastSpan) return {o[0] == o[1] && o[1] == o[2] ? 0.0 : kInfinity, false};
  const Vec3 to = (o[0] * across[0] + o[1] * across[1] + o[2] * across[2]) / span;
  bool outwards = true;
  for (const Vec3& a : across) outwards &= a.dot(to) * span >= 0.0;
  return {to.norm(), outwards};
}

Travel travel_of(const Move& least, const Move& largest, const Move& unit) {
  return {std::max(least.length_mm, largest.length_mm), unit.length_mm,
          largest.outwards ? largest.length_mm : 0.0};
}

}  // namespace

Travel edge_travel(const PlaneFace& a, const PlaneFace& b) {
  return travel_of(move_of(a.n, a.offset_mm.lo, b.n, b.offset_mm.lo),
                   move_of(a.n, a.offset_mm.hi, b.n, b.offset_mm.hi), move_of(a.n, 1.0, b.n, 1.0));
}

namespace {

// Of a corner: the most of its edges and of the points that three of its faces have in common.
Travel corner_travel(const std::vector<PlaneFace>& faces, const std::vector<std::uint32_t>& at) {
  if (at.size() > kMostFacesOfCorner) return {kInfinity, kInfinity, kInfinity};
  Travel most;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const PlaneFace& a = faces[at[i]];
    most.take({std::max(std::fabs(a.offset_mm.lo), std::fabs(a.offset_mm.hi)), 1.0,
               std::max(0.0, a.offset_mm.hi)});
    for (std::size_t j = i + 1; j < at.size(); ++j) {
      const PlaneFace& b = faces[at[j]];
      most.take(edge_travel(a, b));
      for (std::size_t k = j + 1; k < at.size(); ++k) {
        const PlaneFace& c = faces[at[k]];
        const std::array<Vec3, 3> n = {a.n, b.n, c.n};
        most.take(travel_of(move_of(n, {a.offset_mm.lo, b.offset_mm.lo, c.offset_mm.lo}),
                            move_of(n, {a.offset_mm.hi, b.offset_mm.hi, c.offset_mm.hi}),
                            move_of(n, {1.0, 1.0, 1.0})));
      }
    }
  }
  return most;
}

void find_travel(const Solid& solid, PlaneFaces& planes) {
  const auto offset_mm = [](const PlaneFace& face) {
    return std::max(std::fabs(face.offset_mm.lo), std::fabs(face.offset_mm.hi));
  };
  double usual_mm = 0.0;
  for (const PlaneFace& face : planes.faces)
    usual_mm = std::max(usual_mm, PlaneFaces::kUsualTravel * offset_mm(face));
  const std::size_t points = solid.mesh().points_mm.size();
  planes.travel_of.resize(points);
  std::vector<double> most_mm(points, 0.0);
  std::vector<std::uint32_t> at;
  Fans(solid.mesh(), solid.topology()).each([&](std::uint32_t p, const auto& fan) {
    at.clear();
    for (const std::uint32_t t : fan)
      if (const std::uint32_t face = planes.face_of_triangle[t];
          face < PlaneFaces::kWithoutArea && std::find(at.begin(), at.end(), face) == at.end())
        at.push_back(face);
    planes.travel_of[p].take(corner_travel(planes.faces, at));
    for (const std::uint32_t f : at)
      most_mm[p] = std::max(most_mm[p], PlaneFaces::kMostTravel * offset_mm(planes.faces[f]));
  });
  for (std::uint32_t p = 0; p < points; ++p) {
    const Travel& travel = planes.travel_of[p];
    planes.most_travel.take({std::min(travel.by_band_mm, most_mm[p]),
                             std::min(travel.per_mm, PlaneFaces::kMostTravel),
                             std::min(travel.outward_mm, most_mm[p])});
    if (travel.by_band_mm > usual_mm || travel.per_mm > PlaneFaces::kUsualTravel)
      planes.sharp_points.push_back(p);
  }
}

}  // namespace

bool is_plane_band(const SurfaceBand& band, const SurfaceBand::Face& face) {
  if (face.surface) return false;
  return face.grade == DeviationGrade::kPlanar ||
         (face.deviation_mm.lo >= -band.quantum_mm && face.deviation_mm.hi <= band.quantum_mm);
}

PlaneFaces find_plane_faces(const Solid& solid, const SurfaceBand& band) {
  PlaneFaces planes = Merge(solid, band).run();
  find_travel(solid, planes);
  return planes;
}

}  // namespace mortise
