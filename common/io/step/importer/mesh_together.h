#pragma once
#include <vector>

#include "common/io/step/importer/mesh_part.h"

namespace mortise {

/// Parts of these solids, in their order, on all processors. Shapes that share faces or edges are
/// meshed one after another, since a mesh is kept in the shape. Empty: they have more than
/// kMostStepTriangles. Throws what the library throws.
std::vector<StepPart> mesh_together(const std::vector<TopoDS_Shape>& solids,
                                    const MeshOptions& options);

}  // namespace mortise
