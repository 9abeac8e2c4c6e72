#pragma once
#include "common/depth/search/face_pair.h"

namespace mortise {

/// All that is within radius_mm of a circle: a torus with its material inside, or, where the circle
/// is a point, a ball.
struct Tube {
  Vec3 center = Vec3::Zero(), axis = Vec3::UnitZ();
  Vec3 from = Vec3::UnitX();  ///< unit, across the axis: angles about it are counted from here
  double circle_mm = 0.0, radius_mm = 0.0;
  FaceArc around_axis = {}, around_tube = {};  ///< of the face

  /// Of a torus or sphere that is not inward; nothing for other surfaces.
  static std::optional<Tube> of(const Surface& surface, const FaceExtent& extent);
};

/// The surface that a tube meets, in the same frame. Angles about a torus are counted from `from`.
struct TubeWall {
  const Surface* surface = nullptr;
  FaceExtent extent;
  Vec3 from = Vec3::UnitX();
};

/// How far a tube reaches below a wall, mm: bracket of sup -(s_tube + s_wall), and a point of the
/// tube's surface where lo is met.
struct TubeReach {
  Interval reach_mm;
  Vec3 point = Vec3::Zero();
};

/// hi is over all that is within margin_mm of the ends of both faces, lo within both; -infinity
/// where there is no such point. An infinite margin: over both surfaces continued.
///
/// A distance changes by no more than the way walked. So no point of the ball of radius r about c
/// is deeper below the wall than c is, plus r, and straight down from c there is a point that is:
/// the reach is the largest depth of a point of the centre circle, plus r. A hollow torus that is
/// open on one side asks for less: seen from the point h of its own centre circle nearest to c, the
/// ray in direction t leaves the ball at p + sqrt(r^2 - q^2), p and q the parts of c - h along and
/// across t, and t is one of those that the face has.
///
/// On an arc of the circle the distance from the wall's axis and the height along it stay within
/// their values at both ends and a bend, which is small where the axes nearly meet; branch and
/// bound over arcs closes hi to accuracy_mm in some dozen to some thousand steps of 100 ns.
TubeReach tube_reach(const Tube& tube, const TubeWall& wall, double margin_mm, double accuracy_mm);

/// The overlap of a tube with a round surface: face_pair_overlap() for pairs with a torus. Nothing
/// for two hollow faces.
std::optional<FacePairOverlap> tube_overlap(const Surface& a, const FaceExtent& extent_a,
                                            const Surface& b, const FaceExtent& extent_b,
                                            const Pose& X_BA, double margin_mm,
                                            const std::array<PairOffsets, 2>* layers);

}  // namespace mortise
