#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/surface_band.h"
#include "common/session/world/world.h"

namespace mortise {

/// What a scenario says of tolerances, for as long as its session lives: lets a statement be
/// changed while the session runs, with the checks of the file. Implemented where scenarios are
/// read.
class SurfaceRules {
 public:
  virtual ~SurfaceRules() = default;

  /// Of a part, of one of its features, or of a pair of parts or features.
  struct Target {
    PartId part;
    std::string feature;  ///< empty: the whole part
    PartId other_part;    ///< none: the statement is of `part` alone
    std::string other_feature;
  };
  /// What takes the place of what the world has.
  struct Change {
    std::vector<std::pair<PartId, SurfaceBand>> bands;
    /// Every rule of a pair with target.part in it that has bands; only part ids, bands and fit are
    /// filled in.
    std::vector<PairRule> pairs;
  };
  /// States `text` of the target, as it stands in a scenario file behind tolerance:, iso: or in a
  /// fit ("±0.05", "{profile: 0.1}", "H7", "H7/g6"); empty: nothing is stated of it any more. Fails
  /// with the sentence of the file's finding, and is then as before.
  virtual Result<Change> restate(const World& world, const Target& target,
                                 const std::string& text) = 0;
};

/// Puts a change into the world. Cost: the rules of the part, and the judging of its pairs in the
/// next tick.
void apply_change(World& world, const Decision& by, SurfaceRules::Change change);

/// Restates what a decision of kind kSetTolerance says, by the rules of the world; fails, and
/// changes nothing, when it cannot hold.
Status set_tolerance(World& world, const Decision& decision);

}  // namespace mortise
