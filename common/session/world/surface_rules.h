#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/surface_band.h"
#include "common/session/world/part_shapes.h"
#include "common/session/world/world.h"

namespace mortise {

/// Changes tolerances of a scenario while its session runs, with the checks of the file.
/// Implemented in io/scenario, where scenarios are read.
class SurfaceRules {
 public:
  virtual ~SurfaceRules() = default;

  /// A part, one of its features, or a pair of parts or features.
  struct Target {
    PartId part;
    std::string feature;  ///< empty: the whole part
    PartId other_part;    ///< none: the statement is about `part` alone
    std::string other_feature;
  };
  /// Replaces bands and pair rules of the world.
  struct Change {
    std::vector<std::pair<PartId, SurfaceBand>> bands;
    /// Every rule of a pair with target.part in it that has bands; only part ids, bands and fit are
    /// filled in.
    std::vector<PairRule> pairs;
  };
  /// States `text` about the target, as behind tolerance: or iso: of a scenario file or in a fit
  /// ("±0.05", "{profile: 0.1}", "H7", "H7/g6"); empty: removes the statement. On failure it
  /// returns the finding of the reader and changes nothing.
  virtual Result<Change> restate(const World& world, const Target& target,
                                 const std::string& text) = 0;
  /// A part was added: of it is stated what its shape brings, and the patterns of the scenario do
  /// not mean it.
  virtual void add_part(const Part& part, const PartShape& shape) = 0;
  /// How a mesh is to be this part: where it has a face of the same geometry, the face keeps its
  /// name and what was stated of it.
  virtual PartShapes::AsPart as_part(const Part& part) const = 0;
  /// The part has taken a shape that was made so: what is stated of its pairs is what holds of the
  /// faces that it has now. What is stated of others waits until they are there again.
  virtual Change revise(const World& world, PartId part, const PartShape& shape) = 0;
};

/// Does some part, or pair, have deviation or tolerance?
bool evaluates(const World& world);

/// Applies a change to the world. Costs the rules of the part, and the judging of its pairs in the
/// next tick.
void apply_change(World& world, const Decision& by, SurfaceRules::Change change);

/// Applies a decision of kind kSetTolerance by the rules of the world; fails, and changes nothing,
/// when the statement cannot hold.
Status set_tolerance(World& world, const Decision& decision);

}  // namespace mortise
