#pragma once
#include <optional>

#include "common/geometry/feature.h"
#include "common/math/interval.h"

namespace mortise {

/// Above this angle between the axes the bounds of a sliding fit are far from tight and not used.
inline constexpr double kSlidingFitCosine = 0.95;

/// A cylinder or cone about its axis: radius = radius_mm + widening * z, z along the axis from
/// `point` (the apex of a cone).
struct RoundFace {
  Vec3 point = Vec3::Zero(), axis = Vec3::UnitZ();
  double radius_mm = 0.0;
  double widening = 0.0;
  Interval extent_mm;  ///< of the face along its axis

  /// Of a cylinder or cone; nothing for other surfaces.
  static std::optional<RoundFace> of(const Surface& surface, const Interval& extent_mm);
  double radius_at(double z) const { return radius_mm + widening * z; }
};

/// How far a convex round face reaches beyond the wall of a hollow one, mm: bracket, and the point
/// of the convex face where `reach_mm.lo` is met.
struct RoundReach {
  Interval reach_mm;
  Vec3 point = Vec3::Zero();
  Vec3 outward = Vec3::UnitZ();  ///< out of the hollow face's material there
};

/// Bracket of sup f over the convex face where the hollow one is near, f the distance beyond the
/// wall. Both in one frame, axes nearly parallel (kSlidingFitCosine); nothing for others. hi is
/// over the convex face within margin_mm of the hollow one's ends, lo within both; -infinity where
/// there is no such point.
///
/// f is convex, so that along a generator it is largest at an end. Around an end circle it is
/// bounded by its values at the corners of triangles about arcs; it is a square root of a
/// trigonometric polynomial of second degree and bends little where the axes nearly meet, so branch
/// and bound over the angle closes hi to accuracy_mm in a few dozen steps. Exact to rounding.
std::optional<RoundReach> round_reach(const RoundFace& convex, const RoundFace& hollow,
                                      double margin_mm, double accuracy_mm);

}  // namespace mortise
