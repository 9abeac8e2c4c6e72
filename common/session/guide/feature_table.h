#pragma once
#include <cstddef>

#include "common/messages/feature_info.h"
#include "common/session/world/world.h"

namespace mortise {

/// More features are not told: 100,000 of them are 20 MB, which every participant would have to
/// take. Read by session.
inline constexpr std::size_t kMostFeaturesTold = 100'000;

/// What constraints can name: the features of the load and, of meshes in world.recognized, what
/// they show beside. A recognized feature that stands for triangles of declared ones alone, or
/// whose name is taken, is not told twice. Alike parts share a set. Features beyond `most` are left
/// out, whole sets, and counted. O(parts * features + triangles of distinct meshes).
FeatureTable feature_table(const World& world, std::size_t most = kMostFeaturesTold);

/// Meshes, each once and the smallest first, of which nothing is recognized yet and whose size
/// permits it on demand (kRecognizedOnDemand).
std::vector<SolidPtr> unrecognized_meshes(const World& world);

}  // namespace mortise
