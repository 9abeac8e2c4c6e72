#include "tests/bench/judgement_recognition.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mortise::bench {

double recognition_bound_mm(const Surface& truth) {
  constexpr double kLeast_mm = 1e-4, kShare = 1e-6;
  return kLeast_mm + kShare * truth.radius_mm;
}

double surface_error_mm(const TriangleMesh& mesh, const Feature& truth, const Surface& found) {
  if (found.kind != truth.surface.kind || found.inward != truth.surface.inward)
    return std::numeric_limits<double>::infinity();
  double error = 0.0;
  if (found.kind == SurfaceKind::kCylinder || found.kind == SurfaceKind::kSphere)
    error = std::abs(found.radius_mm - truth.surface.radius_mm);
  for (const std::uint32_t t : truth.triangles) {
    // Corners are on the true surface; the middle of a facet is moved out to it.
    const Vec3 middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3.0;
    const Vec3 on =
        middle - truth.surface.signed_distance_mm(middle) * truth.surface.outward_normal(middle);
    error = std::max(error, std::abs(found.signed_distance_mm(on)));
    for (int k = 0; k < 3; ++k)
      error = std::max(error, std::abs(found.signed_distance_mm(mesh.corner(t, k))));
  }
  return error;
}

std::optional<std::size_t> find_feature(const Recognition& recognition, const TriangleMesh& mesh,
                                        const Feature& truth) {
  for (std::size_t i = 0; i < recognition.features.size(); ++i)
    if (surface_error_mm(mesh, truth, recognition.features[i].surface) <=
        recognition_bound_mm(truth.surface))
      return i;
  return std::nullopt;
}

}  // namespace mortise::bench
