#include "client/tools/inspect/propose.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "common/io/scenario/fit_candidates.h"
#include "common/io/scenario/mesh_scenario.h"

namespace mortise {
namespace {

// Sizes that agree within this may carry a code; others are as modelled.
constexpr double kSameSize_mm = 0.003;

bool round(const InspectedPart& part, std::size_t i, bool inward) {
  const Surface& s = part.found.features[i].surface;
  return is_round(s, part.found.measures[i].arc_rad) && s.inward == inward;
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

std::string yaml_end(const InspectedPart& part, const Feature& feature) {
  const std::string name = yaml_word(part.spec.name);
  return name == part.spec.name ? name + "." + feature.name
                                : yaml_word(part.spec.name + "." + feature.name);
}

std::string fit_yaml(const std::vector<InspectedPart>& parts, const ProposedFit& fit) {
  const InspectedPart &a = parts[fit.bore_part], &b = parts[fit.shaft_part];
  const Feature &bore = a.found.features[fit.bore], &shaft = b.found.features[fit.shaft];
  const bool same = std::fabs(fit.clearance_mm) <= kSameSize_mm;
  return fmt::format(
      "#  # bore {:.4f}, shaft {:.4f}, clearance {:+.4f} as modelled\n"
      "#  - {{between: [{}, {}], code: {}}}\n",
      2.0 * bore.surface.radius_mm, 2.0 * shaft.surface.radius_mm, fit.clearance_mm,
      yaml_end(a, bore), yaml_end(b, shaft), same ? "??" : "Ø?? ??");
}

// What is recognized, to be declared; and where tolerances belong, which no mesh tells.
std::string remarks_of(const InspectedPart& part) {
  std::string text;
  for (std::size_t i = 0; i < part.found.features.size(); ++i) {
    const Feature& f = part.found.features[i];
    if (f.surface.kind == SurfaceKind::kPlane) continue;
    text += fmt::format("#      {}: {}\n", f.name, feature_yaml(f, part.found.measures[i]));
  }
  if (!text.empty()) text = "#    features:\n" + text;
  return "#    tolerance: \"±??\"\n" + text;
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
          if (!like_sizes(bore, shaft)) continue;
          if (parts[p].placed && !axes_meet(bore, parts[p].spec.X_WP, shaft, parts[q].spec.X_WP))
            continue;
          fits.push_back({p, i, q, j, 2.0 * (bore.radius_mm - shaft.radius_mm)});
        }
    }
  return fits;
}

std::string proposed_yaml(const std::vector<InspectedPart>& parts) {
  std::vector<PartText> written;
  for (const InspectedPart& part : parts) written.push_back({part.spec, remarks_of(part)});
  std::string name = parts.front().spec.name;
  if (parts.size() == 2) name += ", " + parts.back().spec.name;
  if (parts.size() > 2) name += fmt::format(" and {} more", parts.size() - 1);
  std::string text =
      "# No mesh tells tolerances: without any, parts are judged as modelled. To state one, write "
      "it in the\n# place of ?? and remove the '#' before it. Features need that only where their "
      "surface is to be\n# declared; recognized ones can be named as they are.\n";
  text += scenario_yaml(name, written);
  const std::vector<ProposedFit> fits = proposed_fits(parts);
  if (!fits.empty())
    text += "# What may belong together; the class is unknown, e.g. H7/g6:\n#fits:\n";
  for (const ProposedFit& fit : fits) text += fit_yaml(parts, fit);
  return text;
}

}  // namespace mortise
