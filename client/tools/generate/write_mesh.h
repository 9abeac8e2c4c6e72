#pragma once
#include <ostream>
#include <vector>

#include "common/geometry/feature.h"
#include "common/geometry/mesh.h"

namespace mortise {

/// Wavefront OBJ, mm, all digits of every coordinate: reads back as the same doubles. One group a
/// feature, "rest" for the triangles of none.
void write_obj(const TriangleMesh& mesh, const std::vector<Feature>& features, std::ostream& out);

/// Binary STL, mm. Coordinates become floats.
void write_stl(const TriangleMesh& mesh, std::ostream& out);

}  // namespace mortise
