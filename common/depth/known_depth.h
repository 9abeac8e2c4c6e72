#pragma once
#include "common/depth/patch.h"
#include "common/depth/proof.h"

namespace mortise {

/// No point of the patch lies deeper than this below the layer of K's face that has the triangle,
/// mm, by the closed forms that the proof knows; infinity where none speaks of it. What holds for a
/// declared face of S holds for its sharp neighbours too, which end on it: no point of theirs is
/// outside of it.
double known_depth_mm(const DepthProof& proof, const Patch& patch, std::uint32_t triangle_k);

}  // namespace mortise
