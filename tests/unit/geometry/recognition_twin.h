#pragma once
#include <cstdint>
#include <vector>

#include "common/geometry/feature.h"
#include "common/geometry/mesh.h"

namespace mortise::test {

/// One surface and the triangles that stand for it, ascending. Planes have no size.
struct TwinSurface {
  Surface surface;
  std::vector<std::uint32_t> triangles;
};

/// The slow twin of recognize_features for exact meshes of few facets (planes, cylinders, cones and
/// spheres, in equal steps): every three facets in a row give one surface of each kind, solved in
/// closed form from their planes and corners; it takes all facets around them whose corners lie on
/// it. Largest first, simpler kinds first among equals; what is left over is planes. Shares no
/// code with the library beyond Surface. O(facets^2).
std::vector<TwinSurface> surfaces_by_brute_force(const TriangleMesh& mesh);

}  // namespace mortise::test
