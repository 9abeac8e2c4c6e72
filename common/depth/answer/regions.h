#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "common/base/flat_map.h"
#include "common/depth/search/candidates.h"
#include "common/depth/search/search.h"

namespace mortise {

/// The triangles of both parts that may interfere, or whose meshes overlap, in connected regions.
struct Regions {
  std::vector<Root> roots;
  std::vector<SurfacePoint> middles;  ///< see SearchQuery
  std::size_t count = 0;
  int primary = 0;  ///< the part whose connected triangles make the regions
  FlatMap<std::uint32_t> region_of_triangle;  ///< of the primary part; of those in a region
  std::vector<bool> may_interfere;            ///< by region: false: only the meshes overlap, proven
  bool capped = false;  ///< the work ended: what was not asked counts as interfering, in one region
};

struct RegionsQuery {
  const PairFrame* pair = nullptr;
  const Candidates* candidates = nullptr;
  const KnownOverlaps* known = nullptr;
  std::uint64_t work_cap = 0;
  /// Where no real surfaces can interfere, spend little on whether the meshes overlap.
  bool brief = false;
  /// No point of the largest parts is deeper, proven.
  double most_mm = std::numeric_limits<double>::infinity();
};

/// Decides for every candidate triangle whether it stays out of the other part, spreads over the
/// neighbours of those that do not, and groups them.
Regions find_regions(const RegionsQuery& query, SearchScratch& scratch, std::uint64_t& evaluations);

/// A shell of one part inside the other one without any crossing, by its first triangle.
struct ContainedShell {
  int role = 0;
  std::uint32_t triangle = 0;
};
std::vector<ContainedShell> contained_shells(const PairFrame& pair, std::uint64_t& evaluations);

}  // namespace mortise
