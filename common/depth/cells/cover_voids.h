#pragma once
#include <array>
#include <vector>

#include "common/depth/cells/cover_faces.h"

namespace mortise {

/// A void in the least and in the largest layer.
struct LayerVoids {
  Void of[2];
};

/// The holes of round inner faces, and the pockets and slots of plane ones, that the mesh bears
/// out: no triangle reaches into one, and a point of it is outside of the part.
std::vector<LayerVoids> find_voids(const CoverFaces& faces);

}  // namespace mortise
