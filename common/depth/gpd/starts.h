#pragma once
#include <optional>
#include <vector>

#include "common/depth/depth.h"
#include "common/depth/gpd/twist.h"

namespace mortise::gpd {

/// Twists of the part that is moved which may part the pair, and directions along which it may
/// leave (README, section 7). World frame.
struct Starts {
  std::vector<Vec6> twists;
  std::vector<Vec3> normals, axes;
};

/// Back along the motion of the tick to the contact, as one twist; none where nothing moved.
std::optional<Vec6> back_twist(const GpdQuery& query, const TwistFrame& frame);

/// Back along the motion of the tick; along the normal of the deepest region; fitted to the contact
/// points of all regions; along the axis of a round face or what the surfaces that hold the part
/// share. `evaluations`: added to.
Starts starts_of(const GpdQuery& query, const TwistFrame& frame, std::uint64_t& evaluations);

}  // namespace mortise::gpd
