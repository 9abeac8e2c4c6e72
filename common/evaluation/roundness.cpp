#include "common/evaluation/roundness.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/recognition/measure.h"

namespace mortise {
namespace {

// Designers draw prisms of up to this many flats; what is finer is a tessellated circle.
constexpr double kMostFlats = 64.5;
// A facet this many times as wide as the median one may be a flat on a shaft.
constexpr double kWiderThanOthers = 1.5;
// Fewer facets fix no circle: four corners are on any ellipse whose axes they are symmetric about.
constexpr std::uint32_t kFacetsOfCircle = 5;
// An open arc whose corners are farther off the circle, as a share of its size, may be of another
// curve.
constexpr double kExactArc = 2e-6;

// By how much a triangle turns about the axis, rad. The diagonal of a facet turns as the facet
// does.
double step_rad(const TriangleMesh& mesh, const Surface& surface, std::uint32_t t) {
  std::vector<Vec3> radial;
  for (int k = 0; k < 3; ++k) {
    const Vec3 d = mesh.corner(t, k) - surface.point;
    const Vec3 across = d - d.dot(surface.axis) * surface.axis;
    if (across.norm() > 1e-9 * d.norm()) radial.push_back(across);  // an apex has no angle
  }
  double most = 0.0;
  for (std::size_t i = 0; i < radial.size(); ++i)
    for (std::size_t j = i + 1; j < radial.size(); ++j)
      most =
          std::max(most, std::atan2(radial[i].cross(radial[j]).norm(), radial[i].dot(radial[j])));
  return most;
}

}  // namespace

Roundness roundness_of(const TriangleMesh& mesh, const Feature& feature) {
  Roundness roundness;
  const SurfaceKind kind = feature.surface.kind;
  if (feature.origin != FeatureOrigin::kRecognized || feature.triangles.empty() ||
      (kind != SurfaceKind::kCylinder && kind != SurfaceKind::kCone))
    return roundness;
  const RegionMeasure measure = measure_region(mesh, feature.surface, feature.triangles);
  const bool closed = measure.arc_rad >= 2.0 * std::numbers::pi;
  roundness.is_circle = measure.steps >= kFacetsOfCircle &&
                        (closed || feature.residual_mm <= kExactArc * size_mm(feature.surface, mesh,
                                                                              feature.triangles));
  std::vector<double> steps;
  for (const std::uint32_t t : feature.triangles)
    steps.push_back(step_rad(mesh, feature.surface, t));
  std::vector<double> sorted = steps;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  const double most =
      std::min(2.0 * std::numbers::pi / kMostFlats, kWiderThanOthers * sorted[sorted.size() / 2]);
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (!roundness.is_circle || steps[i] > most) roundness.doubtful.push_back(feature.triangles[i]);
  std::sort(roundness.doubtful.begin(), roundness.doubtful.end());
  return roundness;
}

}  // namespace mortise
