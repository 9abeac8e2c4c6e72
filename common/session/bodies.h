#pragma once
#include <cstdint>
#include <vector>

#include "common/session/world.h"

namespace mortise {

/// What moves as one: a part, or all parts of its group.
struct Body {
  std::vector<std::uint32_t> parts;  ///< indices, rising
  Vec3 reference_W = Vec3::Zero();   ///< of a part: centre of its bounding sphere; of a group: mean
                                     ///< of its parts' reference points
  double radius_mm = 0.0;            ///< all points of the body are this near to reference_W
};

/// The body of part `index` as it stands. O(1) for a part without a group, else O(parts).
Body body_of(const World& world, std::uint32_t index);

/// Constraints that hold the body to parts outside of it, as they stand.
std::vector<Relation> relations_of(const World& world, const Body& body);

}  // namespace mortise
