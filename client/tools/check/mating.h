#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/session/world/world.h"

namespace mortise {

/// What two parts of an assembly are to each other. It stands beside the class of their collision
/// and does not change it.
enum class MatingKind : std::uint8_t {
  kUnknown = 0,
  kTouching,
  kFitStated,     ///< a fit or sizes are stated for the faces that meet
  kFitNotStated,  ///< hole and shaft of the same nominal size, nothing is stated
  kThread,        ///< a screw at a standard size in a hole of its core
  kInsert,        ///< a heat-set insert or a self-tapping screw in a smaller hole
  kPressFit,      ///< a shaft slightly larger than its hole
  kClearanceHole,
};
inline constexpr std::size_t kMatingKindCount = 8;
std::string_view name_of(MatingKind relation);

/// Is an overlap of such parts as they are drawn what the designer wants?
bool is_meant_to_overlap(MatingKind relation);

/// A hole and a shaft on one axis with a common length.
struct CoaxialPair {
  std::size_t feature_a = 0, feature_b = 0;  ///< of the two parts
  double hole_mm = 0.0, shaft_mm = 0.0;      ///< diameters
  double length_mm = 0.0;                    ///< over which both faces lie along the axis
  double share = 1.0;                        ///< of a full turn that both faces cover
  MatingKind relation = MatingKind::kUnknown;
  std::string thread;  ///< "M3", "1/4 UNC", of a thread
  /// π (r_s² − r_h²) L of the share, mm³; 0 with clearance.
  double explained_mm3() const;
};

/// All of two parts as they stand, and what they make of the pair.
struct Mating {
  MatingKind relation = MatingKind::kUnknown;
  std::vector<CoaxialPair> pairs;
  double explained_mm3 = 0.0;  ///< of all that are meant to overlap
  std::string text;            ///< "M2 in Ø1.6 (×2)"
};

/// Finds hole and shaft pairs from cylinders of opposite sides on one axis within 0.05 mm whose
/// lengths overlap. A screw in its hole crosses only end faces, so the faces that meet never show
/// the pair; the axes do. O(cylinders of A × cylinders of B).
class MatingFinder {
 public:
  explicit MatingFinder(const World& world) : world_(world) {}
  Mating find(const Part& a, const Part& b) const;

 private:
  const World& world_;
};

/// The relation of one hole and one shaft by their diameters alone, and the name of the thread.
struct SizeRelation {
  MatingKind relation = MatingKind::kUnknown;
  std::string thread;
};
SizeRelation relation_of_sizes(double hole_mm, double shaft_mm);

}  // namespace mortise
