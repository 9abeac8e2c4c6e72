#pragma once
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "common/io/scenario/fit_candidates.h"
#include "common/io/scenario/placed_statement.h"
#include "common/io/scenario/scene_load.h"

/// Rules of pairs of parts and users: fits, exclusions, who may hold what. Private to scene_load.
namespace mortise {

/// One part while the scene is loaded; same index as World::parts. Parts with equal mesh, features
/// and tolerances share a `kind`.
struct StatedPart {
  std::size_t kind = 0;
  PlacedStatement rest;
  /// Its declared features, from the file or the generator; recognized features come behind and
  /// have no declaration.
  std::vector<Scenario::FeatureSpec> declared;
  std::vector<PlacedStatement> of_feature;  ///< by index of Part::features; what the part's own
                                            ///< and the feature's statement leave together
};

/// "file:line: " of a statement.
std::string place_of(const Scenario& scenario, SourceLine at);

/// Two features, or whole parts, of a pair: part, index of its feature; the lower part first.
using FeaturePair = std::tuple<PartId, std::size_t, PartId, std::size_t>;

/// A statement of the running session about one pair of ends; it replaces that of the file.
struct LiveFit {
  FeaturePair ends;
  std::optional<Scenario::FitSpec> fit;  ///< nothing: no fit
  std::string name_a, name_b;            ///< of the features; empty: the whole part
};
/// In place of the index of a feature that the present mesh of its part does not have.
inline constexpr std::size_t kNoFace = kWholePart - 1;

struct RuleInput {
  const Scenario& scenario;
  const std::vector<Part>& parts;
  const std::vector<StatedPart>& stated;
  std::span<const LiveFit> live = {};
  /// So many parts, from the first on, are those that the scenario speaks of; others were added.
  std::size_t named = static_cast<std::size_t>(-1);
  std::optional<PartId> only = {};  ///< only pairs with this part, and no more than their fits
  bool revised = false;  ///< some part has another mesh: a fit may speak of a face that is gone
};

struct RuleOutcome {
  std::map<std::pair<PartId, PartId>, PairRule> pair_rules;
  std::map<std::pair<PartId, PartId>, std::string> approved_at_start;  ///< and why
  std::map<std::pair<PartId, PartId>, double> min_gaps_mm;
  std::vector<LoadedScene::ResolvedFit> fits;
  std::vector<Finding> findings;
};

/// Pair rules for fits and exclusions, with their findings and resolved fits. A rule that matches
/// nothing, or contradicts another one, is an error.
RuleOutcome rules_of(const RuleInput& input);

}  // namespace mortise
