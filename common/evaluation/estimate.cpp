#include "common/evaluation/estimate.h"

#include <algorithm>
#include <cmath>

#include "common/base/constants.h"
#include "common/geometry/recognition/facets.h"

namespace mortise {
namespace {

// A facet this many times as wide as the next is a plane that the curve is tangent to.
constexpr double kPlaneBeside = 4.0;
// Edges that run more than about 45 degrees apart bend the facet in two directions.
constexpr double kTransverse = 0.7;
// Below a nanometre a sagitta is rounding.
constexpr double kNothing_mm = 1e-6;

struct Bend {
  double sagitta_mm = 0.0;
  Vec3 along = Vec3::Zero();  // of the edge
};

class Estimator {
 public:
  Estimator(const Solid& solid, double quantum_mm)
      : mesh_(solid.mesh()),
        topology_(solid.topology()),
        facets_(build_facets(
            solid, flat_allowance_mm(solid, std::max(quantum_mm, grid_quantum_mm(solid.mesh()))))) {
  }

  std::vector<Interval> run() {
    std::vector<Interval> of_facet(facets_.count());
    for (std::uint32_t f = 0; f < facets_.count(); ++f)
      if (facets_.reliable[f]) of_facet[f] = of(f);
    // A sliver has no direction of its own; it takes what lies beside it.
    std::vector<Interval> of_triangle(mesh_.triangles.size());
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const std::uint32_t f = facets_.of_triangle[t];
      of_triangle[t] = of_facet[f];
      if (facets_.reliable[f]) continue;
      for (const std::uint32_t other : topology_.neighbor[t])
        if (other != Topology::kNone)
          of_triangle[t] = hull(of_triangle[t], of_facet[facets_.of_triangle[other]]);
    }
    return of_triangle;
  }

 private:
  // Extent of a facet across an edge of one of its triangles.
  double width_mm(std::uint32_t f, const Vec3& from, const Vec3& along) const {
    const Vec3 across = facets_.normal[f].cross(along);
    double lo = 0.0, hi = 0.0;
    for (const std::uint32_t t : facets_.triangles(f))
      for (int k = 0; k < 3; ++k) {
        const double d = (mesh_.corner(t, k) - from).dot(across);
        lo = std::min(lo, d);
        hi = std::max(hi, d);
      }
    return hi - lo;
  }

  void add(std::uint32_t f, std::uint32_t g, const Vec3& from, const Vec3& along, bool convex,
           std::vector<Bend>& out_bends, std::vector<Bend>& in_bends) const {
    const double angle = facets_.angle_rad(f, g);
    if (!(angle > 0.0) || angle > kSmoothEdge_rad) return;
    const double mine = width_mm(f, from, along), other = width_mm(g, from, along);
    if (!(mine > 0.0) || mine > kPlaneBeside * other) return;
    // Tangent to a plane, all of the bend is this facet's.
    const double share = other > kPlaneBeside * mine ? 1.0 : mine / (mine + other);
    (convex ? out_bends : in_bends).push_back({0.5 * mine * std::tan(0.5 * angle * share), along});
  }

  Interval of(std::uint32_t f) const {
    std::vector<Bend> out_bends, in_bends;
    for (const std::uint32_t t : facets_.triangles(f))
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t other = topology_.neighbor[t][k];
        const EdgeKind kind = topology_.edge_kind[t][k];
        if (other == Topology::kNone || kind == EdgeKind::kNonManifold) continue;
        const std::uint32_t g = facets_.of_triangle[other];
        if (g == f) continue;
        const Vec3& from = mesh_.corner(t, k);
        const Vec3 edge = mesh_.corner(t, (k + 1) % 3) - from;
        const double length = edge.norm();
        if (!(length > 0.0)) continue;
        if (facets_.reliable[g]) {
          add(f, g, from, edge / length, convex(f, g, edge), out_bends, in_bends);
          continue;
        }
        // Across a sliver to what lies beyond it.
        for (const std::uint32_t beyond : topology_.neighbor[other]) {
          if (beyond == Topology::kNone || beyond == t) continue;
          const std::uint32_t h = facets_.of_triangle[beyond];
          if (h != f && facets_.reliable[h])
            add(f, h, from, edge / length, convex(f, h, edge), out_bends, in_bends);
        }
      }
    return {-of_both_directions(in_bends), of_both_directions(out_bends)};
  }

  // Seen along an edge of f, the next facet turns away from the material, or towards it.
  bool convex(std::uint32_t f, std::uint32_t g, const Vec3& edge) const {
    return facets_.normal[f].cross(facets_.normal[g]).dot(edge) > 0.0;
  }

  static double of_both_directions(const std::vector<Bend>& bends) {
    const Bend* most = nullptr;
    for (const Bend& b : bends)
      if (most == nullptr || b.sagitta_mm > most->sagitta_mm) most = &b;
    if (most == nullptr) return 0.0;
    double across = 0.0;
    for (const Bend& b : bends)
      if (std::fabs(b.along.dot(most->along)) < kTransverse)
        across = std::max(across, b.sagitta_mm);
    const double both = most->sagitta_mm + across;
    return both > kNothing_mm ? both : 0.0;
  }

  const TriangleMesh& mesh_;
  const Topology& topology_;
  const Facets facets_;
};

double preferred(double mm) {
  if (!(mm > 0.0)) return 0.0;
  // The small amount keeps a preferred number itself from being raised to the next.
  return std::pow(10.0, std::ceil(10.0 * std::log10(mm) - 1e-9) / 10.0);
}

}  // namespace

std::vector<Interval> estimated_deviation_mm(const Solid& solid, double quantum_mm) {
  if (solid.mesh().triangles.empty()) return {};
  return Estimator(solid, quantum_mm).run();
}

Interval coarsened(const Interval& estimate_mm) {
  return {-preferred(-kEstimatedDeviationFactor * estimate_mm.lo),
          preferred(kEstimatedDeviationFactor * estimate_mm.hi)};
}

}  // namespace mortise
