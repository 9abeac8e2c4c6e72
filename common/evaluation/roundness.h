#pragma once
#include <cstdint>
#include <vector>

#include "common/geometry/feature.h"
#include "common/geometry/mesh.h"

namespace mortise {

/// Which triangles of a recognized cylinder or cone may stand for something else than that surface
/// (README, section 1). A prism with flats of less than kSmoothEdge_rad has all corners on a
/// cylinder, and nothing but the number of its facets distinguishes its mesh from that of a shaft.
///  - `doubtful`: triangles of facets that are steps of 1/64 turn or more about the axis, or half
///    as wide again as the median step: flats or round, both are possible. All of them where the
///    face has fewer than five facets.
///  - `is_circle`: five facets have six corners, and no other conic has more than four of them; an
///    open arc also has to fit exactly.
/// Other kinds, and features that a designer named or stated, are never doubtful. O(n log n).
struct Roundness {
  std::vector<std::uint32_t> doubtful;  ///< ascending
  bool is_circle = true;
};
Roundness roundness_of(const TriangleMesh& mesh, const Feature& feature);

}  // namespace mortise
