#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/io/placed_statement.h"
#include "common/io/scene_load.h"

/// What pairs of parts say of each other: fits, exclusions, who may hold what. Private to
/// scene_load.
namespace mortise {

/// One part while the scene is put together; same index as World::parts. Parts that are alike in
/// mesh, features and tolerances share a `kind`.
struct StatedPart {
  std::size_t kind = 0;
  PlacedStatement rest;
  std::vector<PlacedStatement> of_feature;  ///< by index of Part::features; what the part's own
                                            ///< and the feature's statement leave together
};

/// "pin*" against "pin_3": '*' stands for any run of characters.
bool matches_pattern(std::string_view pattern, std::string_view name);

/// "file:line: " of a statement.
std::string place_of(const Scenario& scenario, SourceLine at);

/// Adds pair rules for fits and exclusions, and the findings and resolved fits that come with them.
/// A rule that matches nothing, or contradicts another, is an error.
void apply_rules(const Scenario& scenario, const std::vector<StatedPart>& stated,
                 LoadedScene& scene);

}  // namespace mortise
