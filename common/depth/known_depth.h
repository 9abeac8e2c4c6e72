#pragma once
#include "common/depth/patch.h"
#include "common/depth/proof.h"

namespace mortise {

/// By the closed forms that a proof knows, no point of a patch lies deeper below the layer of a
/// face of K than this, mm; infinity where none speaks of it.
struct KnownDepth {
  double face_mm = std::numeric_limits<double>::infinity();  ///< below the face between its ends
  Interval along_mm = kEverywhere_mm;  ///< heights along its surface's axis to which face_mm holds
  /// Below its surface, continued as far as the patch goes; >= face_mm.
  double continued_mm = std::numeric_limits<double>::infinity();
};

/// Of K's face that has the triangle. What holds for a declared face of S holds for its sharp
/// neighbours too, which end on it: no point of theirs is outside of it.
KnownDepth known_depth(const DepthProof& proof, const Patch& patch, std::uint32_t triangle_k);

}  // namespace mortise
