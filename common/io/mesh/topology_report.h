#pragma once
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

}  // namespace mortise
