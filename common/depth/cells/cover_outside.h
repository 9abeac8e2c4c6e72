#pragma once
#include <vector>

#include "common/depth/cells/cover_faces.h"

namespace mortise {

/// Convex cells whose union holds the part, by layer (least, largest); holes are not left out.
struct Outside {
  std::vector<ConvexCell> cells[2];
  double volume_mm3 = 0.0;  ///< about that of the union
};

/// Slabs across the axis of the round faces, each below its outermost line; empty: the part has no
/// axis, or too many slabs.
Outside turned_outside(const CoverFaces& faces);

/// The planes of the part that have all of it on one side, and a box.
Outside polytope_outside(const CoverFaces& faces);

}  // namespace mortise
