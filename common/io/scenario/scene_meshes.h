#pragma once
#include <functional>

#include "common/base/result.h"
#include "common/generators/generators.h"
#include "common/io/mesh/mesh_import.h"
#include "common/session/world/scenario.h"

namespace mortise {

/// Mirrors mesh and features where bit 0, 1, 2 of `axes` is set in x, y, z, and turns the triangles
/// when that is needed to keep them outward.
void mirror_part(GeneratedPart& part, unsigned axes);

/// Gives the mesh of a part, mirrored; the default reads files and runs generators, a replay takes
/// them from its log.
using MeshProvider =
    std::function<Result<ImportedMesh>(const Scenario& scenario, const Scenario::PartSpec& part)>;
MeshProvider default_meshes();

}  // namespace mortise
