#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/feature.h"
#include "common/geometry/mesh.h"

namespace mortise {

/// Two faces are the same while they are closer than this everywhere on their part, mm. Above what
/// another export of the same part puts corners off, below what a designer calls another size. Read
/// by session and io.
inline constexpr double kSameFace_mm = 0.005;

/// Are both the same face of one part, whose points are within reach_mm of each other: of one kind
/// and side, size, axis and place? Where a face ends is not asked.
bool same_face(const Surface& a, const Surface& b, double reach_mm);

/// Centroid of its facets; of none: the point of its surface.
Vec3 middle_of(const Feature& feature, const TriangleMesh& mesh);

/// A face that is to be found again.
struct SoughtFace {
  Surface surface;
  Vec3 middle_P = Vec3::Zero();  ///< of faces on one surface the nearest is meant
};
/// For each sought face the index of the feature that is the same one, each taken once, the nearest
/// pairs first.
std::vector<std::optional<std::size_t>> find_again(std::span<const SoughtFace> sought,
                                                   std::span<const Feature> features,
                                                   const TriangleMesh& mesh, double reach_mm);

}  // namespace mortise
