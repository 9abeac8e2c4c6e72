#pragma once
#include <optional>

#include "common/depth/depth.h"

namespace mortise {

/// Which body of a band: every face at the lower or the upper end of its tolerance, and of where
/// its true surface may be beside the mesh.
struct LayerBody {
  bool largest = false, outer = false;
};

/// The part with each face moved by its offset, as a mesh: every corner goes to where the moved
/// planes around it meet. Of plane faces it is the least or largest body itself; of round ones
/// `outer` holds it and not `outer` lies within. nullptr: the planes around a corner have no common
/// point, or a triangle would turn over.
SolidPtr layer_body(const SolidPtr& part, const SurfaceBand& band, LayerBody which);

}  // namespace mortise
