#pragma once
#include <cstdint>
#include <string>

#include "common/base/ids.h"

namespace mortise {

using ConstraintId = Id<struct ConstraintTag>;
using GroupId = Id<struct GroupTag>;  ///< parts that are held and moved as one

/// The relation that two features keep. Numbers go over the wire and into the log.
enum class ConstraintKind : std::uint8_t {
  kUnknown = 0,
  kCoaxial = 1,           ///< axes (cylinder, cone, torus) on one line; a sphere's centre on it
  kCoplanar = 2,          ///< planes in one plane
  kParallelDistance = 3,  ///< parallel at distance_mm: planes, axes, axis and plane, centres
  kTangent = 4,           ///< planes, cylinders, spheres touch along a line or at a point
};

inline constexpr std::uint8_t kConstraintKindCount = 5;

/// A feature of a part by name: declared in the scenario, brought by a generator, or recognized.
struct FeatureOf {
  PartId part;
  std::string feature;
  friend bool operator==(const FeatureOf&, const FeatureOf&) = default;
};

/// A relation between a feature of a part that the user holds and one of another part. While it is
/// in force, increments move the part only in the freedom that it leaves. Of two opposite
/// directions the nearer one is chosen when the constraint is set.
struct Constraint {
  ConstraintKind kind = ConstraintKind::kUnknown;
  FeatureOf held, other;
  /// With kParallelDistance. From a plane: along its outward normal (of `other` when both are
  /// planes), may be negative; else >= 0.
  double distance_mm = 0.0;
  /// True: the part moves at once to the nearest pose that satisfies the constraint, as by an
  /// increment; a contact on the way stops it. False: with the user's next increment.
  bool snap = false;
  friend bool operator==(const Constraint&, const Constraint&) = default;
};

}  // namespace mortise
