#pragma once
#include <string>
#include <vector>

#include "common/session/world/world.h"

namespace mortise {

/// How near features must be to be offered for a snap.
struct SnapLimits {
  double angle_rad = 0.26;     ///< between axes or normals, either sense
  double distance_mm = 20.0;   ///< between axes, planes, centres
  double radius_share = 0.05;  ///< difference of two radii, of the larger
  std::size_t most = 16;
};
struct SnapCandidate {
  Constraint constraint;       ///< coaxial, or coplanar for planes; snap is set
  double distance_mm = 0.0;    ///< how far the part would move, at its feature
  double angle_rad = 0.0;      ///< and turn
  double radius_off_mm = 0.0;  ///< difference of the radii; 0 for planes
  std::string fit;             ///< that is in force between the two features; empty: none
};

/// Features near those of the part that fit them: a shaft and a bore of nearly the same radius,
/// planes that face each other. First those with a fit in force between them, each time the nearest
/// first. Considers the features of the scene and recognized
/// ones (world.recognized). O(features of the part times features of all others within reach).
std::vector<SnapCandidate> snap_candidates(const World& world, PartId part,
                                           const SnapLimits& limits);

/// The answer to a wish to snap.
struct SnapChoice {
  Refusal refusal = Refusal::kNone;
  std::string text;  ///< the reason of a refusal; else what was chosen, in words
  Constraint constraint;
};

/// The first candidate that the wish allows, that agrees with the constraints in force, and that
/// reduces the freedom. The wish must name held.part; all its other fields may be empty and then
/// allow anything. With other.part named any distance and angle is allowed, else the limits above
/// hold. Changes nothing. Costs the search, and a check of each candidate up to the chosen one.
SnapChoice choose_snap(const World& world, UserId user, const Constraint& wish);

}  // namespace mortise
