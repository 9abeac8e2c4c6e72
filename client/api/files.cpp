#include <mortise/io.h>

#include <fstream>

#include "client/api/convert.h"
#include "client/api/judgement.h"
#include "client/api/part_body.h"
#include "client/picture/picture.h"
#include "client/tools/generate/write_mesh.h"
#include "common/io/scenario/assembly_parts.h"
#include "common/io/scenario/mesh_scenario.h"
#include "common/io/scenario/scene_meshes.h"
#include "common/io/step/step_import.h"

namespace mortise::api {
namespace {

Error wrong(const std::string& text) { return {Code::kInvalidInput, text}; }

}  // namespace

Result<std::vector<PlacedPart>> load_assembly(const std::string& file) {
  if (!mortise::is_step_name(file)) return wrong(file + ": is no STEP file; load() reads meshes");
  mortise::Result<mortise::ScenarioReading> reading =
      mortise::read_scenario_text(mortise::assembly_yaml(file, {}), file);
  if (!reading) return error_of(reading.error());
  mortise::add_assembly(*reading);
  for (const mortise::Finding& finding : reading->findings)
    if (finding.is_error) return wrong(finding.text);
  std::vector<PlacedPart> placed;
  std::map<std::uint32_t, Part> known;  // equal parts share what they are made of
  const mortise::MeshProvider meshes = mortise::default_meshes();
  for (mortise::Scenario::PartSpec& spec : reading->scenario.parts) {
    auto part = known.find(spec.mesh.given_number);
    if (part == known.end()) {
      mortise::Result<mortise::ImportedMesh> mesh = meshes(reading->scenario, spec);
      if (!mesh) return error_of(mesh.error());
      if (mesh->mesh.triangles.empty()) continue;
      mortise::Scenario::PartSpec shape = spec;
      shape.X_WP = {};
      part = known
                 .emplace(spec.mesh.given_number,
                          part_of(std::move(*mesh), std::move(shape), spec.name))
                 .first;
    }
    placed.push_back({part->second.named(spec.name), pose_of(spec.X_WP)});
  }
  if (placed.empty()) return wrong(file + ": has no solid; export the parts as solids");
  return placed;
}

Result<Part> load(const std::string& file, Unit unit) {
  const std::string name = mortise::part_names({file}).front();
  if (mortise::is_step_name(file)) {
    Result<std::vector<PlacedPart>> parts = load_assembly(file);
    if (!parts) return parts.error();
    if (parts->size() > 1)
      return wrong(file + ": has " + std::to_string(parts->size()) +
                   " parts; load_assembly() reads all of them");
    return parts->front().part.named(name);
  }
  mortise::Result<mortise::ImportedMesh> mesh = mortise::import_mesh(file, unit.length_mm);
  if (!mesh) return error_of(mesh.error());
  mortise::Scenario::PartSpec spec;
  spec.mesh.unit_mm = unit.length_mm;
  spec.undeclared = mortise::UndeclaredSurface::kRecognized;
  return part_of(std::move(*mesh), std::move(spec), name);
}

Status save_stl(const Part& part, const std::string& file) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  mortise::write_stl(part.impl().body->solid->mesh(), out);
  out.close();
  if (!out) return Error{Code::kRuntime, file + ": cannot be written; check the path"};
  return {};
}

Result<std::string> picture_svg(const Part& a, const Part& b, const JudgeOptions& options) {
  mortise::Result<mortise::OpenedScene> opened = open_pair(a, b, options);
  if (!opened) return error_of(opened.error());
  mortise::Scratch scratch(options.threads);
  const mortise::JudgeReport report = mortise::judge_world(opened->scene.world, scratch, true);
  const mortise::NumberedRegion* worst = nullptr;
  const std::vector<mortise::NumberedRegion> regions = mortise::numbered_regions(report);
  for (const mortise::NumberedRegion& region : regions)
    if (worst == nullptr || region.verdict->collision_class > worst->verdict->collision_class)
      worst = &region;
  if (worst == nullptr) return wrong("nothing meets: there is nothing to draw");
  const mortise::Result<std::string> picture = mortise::region_picture(
      {&opened->scene.world, worst->pair->a, worst->pair->b, worst->verdict},
      mortise::Canvas::Format::kSvg);
  if (!picture) return error_of(picture.error());
  return *picture;
}

}  // namespace mortise::api
