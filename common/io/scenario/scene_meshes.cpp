#include "common/io/scenario/scene_meshes.h"

#include "common/generators/generators.h"
#include "common/geometry/topology.h"

namespace mortise {
namespace {

Result<ImportedMesh> generated_mesh(const Scenario::PartSpec& part) {
  Result<GeneratedPart> generated = generate(part.mesh.generator, part.mesh.parameters);
  if (!generated) return generated.error();
  ImportedMesh imported;
  imported.mesh = std::move(generated->mesh);
  ImportReport& report = imported.report;
  report.file = "generator " + part.mesh.generator;
  report.format = "generated";
  report.raw_vertices = report.points = imported.mesh.points_mm.size();
  report.raw_triangles = report.triangles = imported.mesh.triangles.size();
  const Topology topology = build_topology(imported.mesh);
  report.boundary_edges = topology.boundary_edges;
  report.non_manifold_edges = topology.non_manifold_edges;
  report.misoriented_edges = topology.misoriented_edges;
  report.components = topology.components;
  report.volume_mm3 = topology.volume_mm3;
  report.closed = topology.closed();
  return imported;
}

}  // namespace

MeshProvider default_meshes() {
  return [](const Scenario& scenario, const Scenario::PartSpec& part) -> Result<ImportedMesh> {
    if (!part.mesh.generator.empty()) return generated_mesh(part);
    const std::filesystem::path folder = std::filesystem::path(scenario.file).parent_path();
    return import_mesh(folder / part.mesh.file, part.mesh.unit_mm);
  };
}

}  // namespace mortise
