#pragma once
#include <cstddef>
#include <memory>
#include <vector>

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

/// What the table is made of, by itself, so that another thread can make it: of each part that is
/// present its mesh, its features, and what its mesh shows (null: not searched). O(parts).
struct FeatureSources {
  struct OfPart {
    PartId part;
    SolidPtr solid;
    SharedVector<Feature> features;
    std::shared_ptr<const std::vector<Feature>> shown;
  };
  std::vector<OfPart> parts;
};
FeatureSources feature_sources(const World& world);
FeatureTable feature_table(const FeatureSources& sources, std::size_t most = kMostFeaturesTold);

/// Meshes, each once and the smallest first, that were not yet searched for features and are small
/// enough for it (kRecognizedOnDemand).
std::vector<SolidPtr> unrecognized_meshes(const World& world);

}  // namespace mortise
