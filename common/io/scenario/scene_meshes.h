#pragma once
#include <functional>

#include "common/base/result.h"
#include "common/io/mesh/mesh_import.h"
#include "common/session/world/scenario.h"

namespace mortise {

/// Gives the mesh of a part; the default reads files and runs generators, a replay takes them from
/// its log.
using MeshProvider =
    std::function<Result<ImportedMesh>(const Scenario& scenario, const Scenario::PartSpec& part)>;
MeshProvider default_meshes();

}  // namespace mortise
