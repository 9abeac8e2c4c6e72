#pragma once
#include <cstdint>
#include <optional>

#include "common/depth/depth.h"
#include "common/depth/search/candidates.h"
#include "common/depth/search/search.h"

namespace mortise {

struct DeclaredRegion {
  /// True: the closed form alone says that it is certain, and knows no neighbour that cuts a face
  /// short: to be searched like any other pair of faces.
  bool left_to_search = false;
  std::optional<OverlapRegion> region;  ///< none: not even possible
  /// No point of the meshes of these faces is deeper, inside neither: the closed form, and how far
  /// the meshes stand out of their surfaces.
  double most_mm = 0.0;
};

/// The region of a pair of declared faces whose overlap has a closed form: certain and possible are
/// those of the form (README, section 8), only the overlap of the meshes is searched, by
/// `mesh_work` evaluations at most; 0: it is looked for at some points only. Adds to `evaluations`.
DeclaredRegion find_declared_region(const PairFrame& pair, const OverlapQuery& query,
                                    const KnownFacePair& known, std::uint64_t mesh_work,
                                    SearchScratch& scratch, std::uint64_t& evaluations);

}  // namespace mortise
