#pragma once
#include "common/depth/depth.h"
#include "tests/bench/gpd_pairs.h"

namespace mortise::bench {

struct GpdWord {
  OverlapResult overlap;
  GeneralizedDepth depth;
  bool apart = false;   ///< the motion as told, applied: the meshes are apart
  double time_s = 0.0;  ///< of the generalized depth alone
};

/// `first`: what the lazy search told, where the full one begins.
GpdWord ask_gpd(const GpdPair& pair, Refinement refinement, const GpdWord* first = nullptr);

/// What holds show when they are asked beyond the motion that is known, mm: were they wrong, it
/// would be more than that motion is long.
double holds_beyond_mm(const GpdPair& pair, const GpdWord& word);

/// The shortest motion that a search finds with `effort` times as many starts: random twists, each
/// pushed out and descended from. No longer than what was told. mm.
double search_longer(const GpdPair& pair, const GpdWord& word, int effort);

}  // namespace mortise::bench
