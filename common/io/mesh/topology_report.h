#pragma once
#include <string>
#include <utility>

#include "common/geometry/topology.h"
#include "common/io/mesh/mesh_import.h"

namespace mortise {

/// Edges, shells, volume: what an import report says of a mesh.
inline void note_topology(const TriangleMesh& mesh, ImportReport& report) {
  const Topology topology = build_topology(mesh);
  report.boundary_edges = topology.boundary_edges;
  report.non_manifold_edges = topology.non_manifold_edges;
  report.misoriented_edges = topology.misoriented_edges;
  report.components = topology.components;
  report.volume_mm3 = topology.volume_mm3;
  report.closed = topology.closed();
}

/// A mesh that no file of meshes brought, as if it were read from one in which all is well.
inline ImportedMesh with_report(TriangleMesh mesh, std::string file, std::string format) {
  ImportedMesh imported;
  imported.mesh = std::move(mesh);
  ImportReport& report = imported.report;
  report.file = std::move(file);
  report.format = std::move(format);
  report.raw_vertices = report.points = imported.mesh.points_mm.size();
  report.raw_triangles = report.triangles = imported.mesh.triangles.size();
  note_topology(imported.mesh, report);
  return imported;
}

}  // namespace mortise
