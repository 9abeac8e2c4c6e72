#include "client/tools/inspect/propose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mortise {
namespace {

constexpr double kLikeRadii = 0.03;
constexpr double kLikeAxes_rad = std::numbers::pi / 180.0;
constexpr double kBesideAxis = 0.1;  // of the radius
// Sizes that agree within this may carry a code; others are as modelled.
constexpr double kSameSize_mm = 0.003;

bool round(const InspectedPart& part, std::size_t i, bool inward) {
  const Surface& s = part.found.features[i].surface;
  return s.kind == SurfaceKind::kCylinder && s.inward == inward &&
         part.found.measures[i].arc_rad > std::numbers::pi;
}

bool axes_meet(const InspectedPart& a, const Surface& bore, const InspectedPart& b,
               const Surface& shaft) {
  const Vec3 axis_a = a.X_WP.q * bore.axis, axis_b = b.X_WP.q * shaft.axis;
  if (std::asin(std::min(1.0, axis_a.cross(axis_b).norm())) > kLikeAxes_rad) return false;
  const Vec3 d = b.X_WP * shaft.point - a.X_WP * bore.point;
  return (d - d.dot(axis_a) * axis_a).norm() <= kBesideAxis * bore.radius_mm;
}

std::string triple(const Vec3& v) {
  const auto clean = [](double x) { return std::fabs(x) < 5e-10 ? 0.0 : x; };
  return fmt::format("[{:.9g}, {:.9g}, {:.9g}]", clean(v.x()), clean(v.y()), clean(v.z()));
}

std::string feature_yaml(const Feature& f, const FeatureMeasure& m) {
  const Surface& s = f.surface;
  constexpr double kDegPerRad = 180.0 / std::numbers::pi;
  const std::string along = fmt::format("along: [{:.6f}, {:.6f}]", m.along_mm.lo, m.along_mm.hi);
  const std::string place = fmt::format("point: {}, axis: {}", triple(s.point), triple(s.axis));
  const char* inward = s.inward ? "true" : "false";
  switch (s.kind) {
    case SurfaceKind::kCylinder:
      return fmt::format("{{kind: cylinder, {}, radius: {:.9g}, inward: {}, {}}}", place,
                         s.radius_mm, inward, along);
    case SurfaceKind::kCone:
      return fmt::format("{{kind: cone, {}, half_angle_deg: {:.9g}, inward: {}, {}}}", place,
                         s.half_angle_rad * kDegPerRad, inward, along);
    case SurfaceKind::kSphere:
      return fmt::format("{{kind: sphere, point: {}, radius: {:.9g}, inward: {}}}", triple(s.point),
                         s.radius_mm, inward);
    case SurfaceKind::kTorus:
      return fmt::format("{{kind: torus, {}, radius: {:.9g}, tube_radius: {:.9g}, inward: {}}}",
                         place, s.radius_mm, s.tube_radius_mm, inward);
    default:
      return fmt::format("{{kind: plane, {}}}", place);
  }
}

std::string fit_yaml(const std::vector<InspectedPart>& parts, const ProposedFit& fit) {
  const InspectedPart &a = parts[fit.bore_part], &b = parts[fit.shaft_part];
  const Feature &bore = a.found.features[fit.bore], &shaft = b.found.features[fit.shaft];
  const bool same = std::fabs(fit.clearance_mm) <= kSameSize_mm;
  const std::string what = same ? "code: H7/g6" : "plus_minus: 0";
  return fmt::format(
      "  # bore {:.4f}, shaft {:.4f}, clearance {:+.4f} as modelled{}\n"
      "  - {{between: [{}.{}, {}.{}], {}}}\n",
      2.0 * bore.surface.radius_mm, 2.0 * shaft.surface.radius_mm, fit.clearance_mm,
      same ? "; the class is a proposal" : "; say the tolerances", a.name, bore.name, b.name,
      shaft.name, what);
}

}  // namespace

std::vector<ProposedFit> proposed_fits(const std::vector<InspectedPart>& parts) {
  std::vector<ProposedFit> fits;
  for (std::size_t p = 0; p < parts.size(); ++p)
    for (std::size_t i = 0; i < parts[p].found.features.size(); ++i) {
      if (!round(parts[p], i, true)) continue;
      const Surface& bore = parts[p].found.features[i].surface;
      for (std::size_t q = 0; q < parts.size(); ++q)
        for (std::size_t j = 0; q != p && j < parts[q].found.features.size(); ++j) {
          if (!round(parts[q], j, false)) continue;
          const Surface& shaft = parts[q].found.features[j].surface;
          if (std::fabs(bore.radius_mm - shaft.radius_mm) > kLikeRadii * bore.radius_mm) continue;
          if (parts[p].placed && !axes_meet(parts[p], bore, parts[q], shaft)) continue;
          fits.push_back({p, i, q, j, 2.0 * (bore.radius_mm - shaft.radius_mm)});
        }
    }
  return fits;
}

std::string proposed_yaml(const std::vector<InspectedPart>& parts) {
  std::string text = "units: mm\nparts:\n";
  for (const InspectedPart& part : parts) {
    text += fmt::format("  - name: {}\n", part.name);
    if (!part.placed)
      text += fmt::format("    mesh: {{file: \"{}\", unit: {}}}\n", part.file, part.unit);
    bool first = true;
    for (std::size_t i = 0; i < part.found.features.size(); ++i) {
      const Feature& f = part.found.features[i];
      if (f.surface.kind == SurfaceKind::kPlane) continue;
      if (first) text += "    features:\n";
      first = false;
      text += fmt::format("      {}: {}\n", f.name, feature_yaml(f, part.found.measures[i]));
    }
  }
  const std::vector<ProposedFit> fits = proposed_fits(parts);
  if (!fits.empty()) text += "fits:\n";
  for (const ProposedFit& fit : fits) text += fit_yaml(parts, fit);
  return text;
}

}  // namespace mortise
