#include "client/tools/inspect/inspect.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "client/tools/inspect/propose.h"
#include "common/io/scenario/mesh_scenario.h"
#include "common/io/scenario/open_scene.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
// A part of thousands of features is not read line by line; --json has them all.
constexpr std::size_t kMostRows = 60;

InspectedPart inspected(Scenario::PartSpec spec, SolidPtr solid, ImportReport report) {
  InspectedPart part;
  part.spec = std::move(spec);
  part.solid = std::move(solid);
  part.report = std::move(report);
  part.found =
      recognize_features(*part.solid, {.quantum_mm = part.report.quantum_mm, .threads = 0});
  return part;
}

Result<std::vector<InspectedPart>> inspect_scenario(const std::string& file) {
  const auto opened = open_scene(file);
  if (!opened) return opened.error();
  for (const Finding& f : opened->findings)
    if (f.is_error) return fail(Code::kInvalidInput, f.text);
  std::vector<InspectedPart> parts;
  for (std::size_t i = 0; i < opened->scenario.parts.size(); ++i) {
    Scenario::PartSpec spec = opened->scenario.parts[i];
    // The text that is proposed may lie in another folder: it names files as we see them from here.
    if (!spec.mesh.file.empty())
      spec.mesh.file = (std::filesystem::path(file).parent_path() / spec.mesh.file).string();
    parts.push_back(
        inspected(std::move(spec), opened->scene.world.parts[i].solid, opened->scene.imports[i]));
    parts.back().placed = true;
  }
  return parts;
}

std::string size_of(const Surface& s) {
  switch (s.kind) {
    case SurfaceKind::kCylinder:
    case SurfaceKind::kSphere:
      return fmt::format("Ø{:.4f}", 2.0 * s.radius_mm);
    case SurfaceKind::kCone:
      return fmt::format("{:.3f}° half", s.half_angle_rad * kDegPerRad);
    case SurfaceKind::kTorus:
      return fmt::format("R{:.4f} r{:.4f}", s.radius_mm, s.tube_radius_mm);
    default:
      return "";
  }
}

std::string vector_text(const Vec3& v) {
  const auto clean = [](double x) { return std::fabs(x) < 5e-5 ? 0.0 : x; };
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", clean(v.x()), clean(v.y()), clean(v.z()));
}

std::string row_of(const Feature& f, const FeatureMeasure& m) {
  const Vec3 low = f.surface.point + m.along_mm.lo * f.surface.axis;
  return fmt::format("  {:<12}{:<22}{:<26}{:<24}{:>7}{:>8.1f}{:>10.3f}{:>11.2g}{:>11.3g}\n", f.name,
                     size_of(f.surface), vector_text(low), vector_text(f.surface.axis), m.facets,
                     m.arc_rad * kDegPerRad, m.along_mm.width(), f.residual_mm * 1e3,
                     m.chord_error_mm * 1e3);
}

std::string part_text(const InspectedPart& part) {
  const Topology& topology = part.solid->topology();
  const Vec3 size = part.solid->bounds().hi - part.solid->bounds().lo;
  std::string text = fmt::format(
      "{}: {} triangles, {} shells, size {:.3f} x {:.3f} x {:.3f} mm, {}\n", part.spec.name,
      part.solid->mesh().triangles.size(), part.solid->shells().size(), size.x(), size.y(),
      size.z(),
      topology.closed() ? fmt::format("closed, {:.3f} mm³", topology.volume_mm3)
                        : fmt::format("not closed: {} open, {} non-manifold, {} misoriented edges",
                                      topology.boundary_edges, topology.non_manifold_edges,
                                      topology.misoriented_edges));
  for (const std::string& note : notes_of(part.report)) text += "  note: " + note + "\n";
  std::size_t planes = 0, rows = 0;
  for (const Feature& f : part.found.features) planes += f.surface.kind == SurfaceKind::kPlane;
  if (planes < part.found.features.size())
    text += fmt::format("  {:<12}{:<21}{:<26}{:<24}{:>7}{:>8}{:>10}{:>11}{:>11}\n", "feature",
                        "size, mm", "from", "axis", "facets", "arc, °", "long, mm", "resid., µm",
                        "chord, µm");
  for (std::size_t i = 0; i < part.found.features.size(); ++i) {
    if (part.found.features[i].surface.kind == SurfaceKind::kPlane || ++rows > kMostRows) continue;
    text += row_of(part.found.features[i], part.found.measures[i]);
  }
  if (rows > kMostRows) text += fmt::format("  ... {} more; --json lists all\n", rows - kMostRows);
  return text + fmt::format(
                    "  {} planes; {} of {} triangles belong to no feature ({} flat facets and "
                    "{} rows of facets may be parts of other curves)\n",
                    planes, part.found.triangles_left, part.solid->mesh().triangles.size(),
                    part.found.doubtful_planes, part.found.doubtful_rows);
}

}  // namespace

Result<std::vector<InspectedPart>> inspect_files(const std::vector<std::string>& files,
                                                 double unit_mm) {
  std::vector<InspectedPart> parts;
  const std::vector<std::string> names = part_names(files);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string& file = files[i];
    if (file.ends_with(".yaml") || file.ends_with(".yml")) {
      if (files.size() > 1)
        return fail(Code::kInvalidInput, file + ": a scenario is inspected alone");
      return inspect_scenario(file);
    }
    Result<ImportedMesh> mesh = import_mesh(file, unit_mm);
    if (!mesh) return mesh.error();
    if (mesh->mesh.triangles.empty()) return fail(Code::kInvalidInput, file + ": has no triangles");
    Scenario::PartSpec spec;
    spec.name = names[i];
    spec.mesh.file = file;
    spec.mesh.unit_mm = unit_mm;
    spec.moving = i > 0;
    parts.push_back(inspected(std::move(spec), std::make_shared<const Solid>(std::move(mesh->mesh)),
                              mesh->report));
  }
  return parts;
}

std::string inspect_text(const std::vector<InspectedPart>& parts) {
  std::string text;
  for (const InspectedPart& part : parts) text += part_text(part) + "\n";
  return text;
}

Json inspect_json(const std::vector<InspectedPart>& parts) {
  Json json;
  json["schema"] = "mortise/inspect/1";
  json["parts"] = Json::array();
  for (const InspectedPart& part : parts) {
    const Topology& topology = part.solid->topology();
    Json p{{"name", part.spec.name},
           {"file", part.report.file},
           {"notes", notes_of(part.report)},
           {"triangles", part.solid->mesh().triangles.size()},
           {"shells", part.solid->shells().size()},
           {"closed", topology.closed()},
           {"open_edges", topology.boundary_edges},
           {"non_manifold_edges", topology.non_manifold_edges},
           {"misoriented_edges", topology.misoriented_edges},
           {"quantum_mm", part.report.quantum_mm},
           {"size_mm", json_of(Vec3(part.solid->bounds().hi - part.solid->bounds().lo))},
           {"triangles_left", part.found.triangles_left},
           {"doubtful_planes", part.found.doubtful_planes},
           {"doubtful_rows", part.found.doubtful_rows}};
    p["features"] = Json::array();
    for (std::size_t i = 0; i < part.found.features.size(); ++i) {
      const Feature& f = part.found.features[i];
      const FeatureMeasure& m = part.found.measures[i];
      p["features"].push_back({{"name", f.name},
                               {"kind", name_of(f.surface.kind)},
                               {"inward", f.surface.inward},
                               {"radius_mm", f.surface.radius_mm},
                               {"tube_radius_mm", f.surface.tube_radius_mm},
                               {"half_angle_rad", f.surface.half_angle_rad},
                               {"point_mm", json_of(f.surface.point)},
                               {"axis", json_of(f.surface.axis)},
                               {"along_mm", json_of(m.along_mm)},
                               {"facets", m.facets},
                               {"arc_rad", m.arc_rad},
                               {"residual_mm", f.residual_mm},
                               {"chord_error_mm", m.chord_error_mm},
                               {"triangles", f.triangles.size()}});
    }
    json["parts"].push_back(std::move(p));
  }
  json["fits"] = Json::array();
  for (const ProposedFit& fit : proposed_fits(parts))
    json["fits"].push_back({{"bore", parts[fit.bore_part].spec.name + "." +
                                         parts[fit.bore_part].found.features[fit.bore].name},
                            {"shaft", parts[fit.shaft_part].spec.name + "." +
                                          parts[fit.shaft_part].found.features[fit.shaft].name},
                            {"clearance_mm", fit.clearance_mm}});
  return json;
}

}  // namespace mortise
