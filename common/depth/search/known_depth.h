#pragma once
#include "common/depth/search/patch.h"
#include "common/depth/search/proof.h"

namespace mortise {

/// By the closed forms that a proof knows, no point of a patch lies deeper below the layer of a
/// face of K than this, mm; infinity without such a closed form.
struct KnownDepth {
  double face_mm = std::numeric_limits<double>::infinity();  ///< below the face between its ends
  Interval along_mm = kEverywhere_mm;  ///< heights along its surface's axis to which face_mm holds
  /// Below its surface, continued as far as the patch goes; >= face_mm.
  double continued_mm = std::numeric_limits<double>::infinity();
};

/// For the face of K that has the triangle. A bound of a declared face of S also holds for its
/// sharp neighbours, because they end on it and none of their points is outside of it.
KnownDepth known_depth(const DepthProof& proof, const Patch& patch, std::uint32_t triangle_k);

}  // namespace mortise
