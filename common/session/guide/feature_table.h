#pragma once
#include <cstddef>

#include "common/messages/feature_info.h"
#include "common/session/world/world.h"

namespace mortise {

/// Most features that are published: 100,000 of them are 20 MB for every participant. Read by
/// session.
inline constexpr std::size_t kMostFeaturesTold = 100'000;

/// The features that constraints can name: those of the scene and the recognized ones of meshes in
/// world.recognized. A recognized feature whose triangles all belong to declared ones, or whose
/// name is taken, is left out. Equal parts share a set. Sets beyond `most` features are left out
/// and counted. O(parts * features + triangles of distinct meshes).
FeatureTable feature_table(const World& world, std::size_t most = kMostFeaturesTold);

/// Meshes, each once and the smallest first, that were not yet searched for features and are small
/// enough for it (kRecognizedOnDemand).
std::vector<SolidPtr> unrecognized_meshes(const World& world);

}  // namespace mortise
