#include "common/geometry/recognition/facets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace mortise {
namespace {

// Share of a mesh's radius that corners of a plane may be off for rounding of doubles and of the
// program that wrote them; far below the height of any drawn curve.
constexpr double kFlatShare = 1e-9;
// A triangle is as wide as this many flatness allowances before its normal says anything.
constexpr double kSliverHeights = 8.0;
// Triangles of one plane look the same way.
constexpr double kSameWay = 0.99;

class Grouping {
 public:
  Grouping(const Solid& solid, double flat_mm)
      : mesh_(solid.mesh()), topology_(solid.topology()), flat_mm_(flat_mm) {
    const auto count = static_cast<std::uint32_t>(mesh_.triangles.size());
    for (std::uint32_t t = 0; t < count; ++t) {
      const Vec3 &a = mesh_.corner(t, 0), &b = mesh_.corner(t, 1), &c = mesh_.corner(t, 2);
      area_.push_back(0.5 * (b - a).cross(c - a));
      const double longest = std::sqrt(
          std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
      wide_.push_back(2.0 * area_[t].norm() > kSliverHeights * flat_mm_ * longest);
    }
  }

  Facets run() {
    const auto count = static_cast<std::uint32_t>(mesh_.triangles.size());
    facets_.of_triangle.assign(count, kNone);
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0U);
    std::vector<double> size(count);
    for (std::uint32_t t = 0; t < count; ++t) size[t] = wide_[t] ? area_[t].squaredNorm() : 0.0;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return size[a] > size[b]; });
    facets_.begin.push_back(0);
    for (const std::uint32_t t : order)
      if (facets_.of_triangle[t] == kNone) grow(t);
    return std::move(facets_);
  }

 private:
  static constexpr std::uint32_t kNone = Topology::kNone;

  // The plane of the group so far; it settles as the group grows.
  struct Plane {
    Vec3 area = Vec3::Zero();
    Vec3 corner_sum = Vec3::Zero();
    double corners = 0.0;
    Vec3 point = Vec3::Zero(), normal = Vec3::Zero();

    void settle() {
      const double length = area.norm();
      normal = length > 0.0 ? Vec3(area / length) : Vec3::Zero();
      point = corner_sum / corners;
    }
  };

  void add(Plane& plane, std::uint32_t t) const {
    plane.area += area_[t];
    for (int k = 0; k < 3; ++k) plane.corner_sum += mesh_.corner(t, k);
    plane.corners += 3.0;
  }

  bool lies_in(const Plane& plane, std::uint32_t t) const {
    for (int k = 0; k < 3; ++k)
      if (std::fabs((mesh_.corner(t, k) - plane.point).dot(plane.normal)) > flat_mm_) return false;
    return !wide_[t] || area_[t].dot(plane.normal) > kSameWay * area_[t].norm();
  }

  void grow(std::uint32_t seed) {
    const auto facet = static_cast<std::uint32_t>(facets_.begin.size() - 1);
    const std::size_t first = facets_.members.size();
    Plane plane;
    const auto take = [&](std::uint32_t t) {
      facets_.of_triangle[t] = facet;
      facets_.members.push_back(t);
      add(plane, t);
    };
    take(seed);
    plane.settle();
    std::size_t settled_at = 1;
    if (wide_[seed])
      for (std::size_t next = first; next < facets_.members.size(); ++next)
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t t = facets_.members[next];
          const std::uint32_t other = topology_.neighbor[t][k];
          if (other == kNone || facets_.of_triangle[other] != kNone ||
              topology_.edge_kind[t][k] == EdgeKind::kNonManifold || !lies_in(plane, other))
            continue;
          take(other);
          if (facets_.members.size() - first < 2 * settled_at) continue;
          settled_at = facets_.members.size() - first;
          plane.settle();
        }
    plane.settle();
    std::sort(facets_.members.begin() + static_cast<std::ptrdiff_t>(first), facets_.members.end());
    facets_.begin.push_back(static_cast<std::uint32_t>(facets_.members.size()));
    facets_.reliable.push_back(wide_[seed]);
    facets_.normal.push_back(wide_[seed] ? plane.normal : Vec3::Zero());
    facets_.area_mm2.push_back(plane.area.norm());
  }

  const TriangleMesh& mesh_;
  const Topology& topology_;
  double flat_mm_ = 0.0;
  std::vector<Vec3> area_;
  std::vector<bool> wide_;
  Facets facets_;
};

}  // namespace

double Facets::angle_rad(std::uint32_t f, std::uint32_t g) const {
  if (f == g || !reliable[f] || !reliable[g]) return 0.0;
  return std::atan2(normal[f].cross(normal[g]).norm(), normal[f].dot(normal[g]));
}

double flat_allowance_mm(const Solid& solid, double quantum_mm) {
  return 2.0 * quantum_mm + kFlatShare * solid.sphere().radius_mm;
}

double grid_quantum_mm(const TriangleMesh& mesh) {
  // Last decimals of a file. A finer one is less than a nanometre.
  constexpr std::array<double, 4> kSteps_mm{1e-3, 1e-4, 1e-5, 1e-6};
  // Beyond this share of a step a coordinate lies beside the grid; floats are off by less.
  constexpr double kOnGrid = 0.02;
  // So many coordinates that use the last decimal are no design in round numbers.
  constexpr std::size_t kEnough = 60;
  for (const double step : kSteps_mm) {
    std::size_t fine = 0;
    bool all = true;
    for (std::size_t i = 0; i < mesh.points_mm.size() && all; ++i)
      for (const double x : mesh.points_mm[i]) {
        const double steps = x / step, whole = std::round(steps);
        all = all && std::fabs(steps - whole) <= kOnGrid;
        fine += std::fabs(std::remainder(whole, 10.0)) > 0.5 ? 1U : 0U;
      }
    if (all) return fine >= kEnough ? 0.5 * step : 0.0;
  }
  return 0.0;
}

Facets build_facets(const Solid& solid, double flat_mm) { return Grouping(solid, flat_mm).run(); }

}  // namespace mortise
