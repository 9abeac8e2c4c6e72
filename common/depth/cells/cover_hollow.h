#pragma once
#include <vector>

#include "common/depth/cells/cover_voids.h"

namespace mortise {

/// Holes along an axis with round and plane sides: of a D-shaft, a rounded square, an obround. As
/// find_voids().
std::vector<LayerVoids> find_hollows(const CoverFaces& faces);

}  // namespace mortise
