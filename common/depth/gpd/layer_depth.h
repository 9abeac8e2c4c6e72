#pragma once
#include <optional>

#include "common/depth/generalized_depth.h"

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

/// Generalized penetration depth of the least and of the largest bodies (README, section 7):
/// however the parts are made, some motion of hi parts them, and none shorter than lo. Positive
/// exactly where the class of the pair is real, or at least potential. Empty: not known.
struct LayerDepths {
  std::optional<Interval> least_mm, largest_mm;
};

/// Of the pair at the poses of the query, for the part that it moves. Four overlaps and four
/// searches: for whoever asks.
LayerDepths depths_of_layers(const SolidPtr& a, const SolidPtr& b, const GpdQuery& query,
                             CcdScratch& scratch);

}  // namespace mortise
