#pragma once
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/recognition/recognition.h"
#include "common/geometry/surface_band.h"
#include "common/io/mesh/mesh_import.h"
#include "common/session/world/scenario.h"

/// Recognized features of a part beside its declared ones. Private to scene_load.
namespace mortise {

/// The recognized feature of this name; nothing when there is none.
const Feature* find_recognized(const Recognition& recognition, const std::string& name);

/// "known: bore_1, bore_2, ...", the first of them, for messages.
std::string recognized_names(const Recognition& recognition);

/// The recognized features that are not declared, without the triangles of declared ones; a feature
/// without any triangle left is dropped. A name that a declared feature has gets "_recognized".
std::vector<Feature> undeclared_features(const Recognition& recognition,
                                         const std::vector<Feature>& declared,
                                         std::size_t triangles);

/// For each triangle the feature that has it: of those that name it the one to which it lies
/// closer, the earlier one on a tie; -1: none.
std::vector<std::int32_t> owners_of(const std::vector<Feature>& features, const TriangleMesh& mesh);

/// The summary of all estimated faces of a band: their hull. Nothing when there are none.
std::optional<Interval> estimated_deviation_of(const SurfaceBand& band);

}  // namespace mortise
