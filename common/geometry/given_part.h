#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/feature.h"
#include "common/geometry/mesh.h"
#include "common/math/interval.h"

namespace mortise {

/// Triangles of a part whose true surface is none of those that Surface knows, with how far it lies
/// off them, outward, as somebody measured it.
struct FreeformFace {
  Interval deviation_mm;
  std::vector<std::uint32_t> triangles;
};

/// A part as a CAD file states it: a mesh, and for each triangle the surface that it stands for.
/// Immutable and shared by all places of the part.
struct GivenPart {
  std::string file, product;  ///< where it comes from, for messages
  TriangleMesh mesh;
  std::vector<Feature> features;  ///< with their triangles; names are unique in the part
  std::vector<FreeformFace> freeform;
  double volume_mm3 = 0.0;  ///< of the exact solids; 0: not known
  std::vector<std::string> notes;
};

}  // namespace mortise
