#pragma once
#include <cstdint>
#include <vector>

#include "common/depth/cells/cover.h"
#include "common/math/pose.h"

namespace mortise {

/// A bound at a wall may be larger than the least one by so much, mm: nobody looks closer.
inline constexpr double kBoundAccuracy_mm = 2e-5;

/// How a cell S is seen from the frame K of the other part, over a span of time: every point of it
/// stays within spread_mm of the straight way from its place by X_KS[0] to that by X_KS[1].
struct Chord {
  Pose X_KS[2];
  int ends = 1;  ///< 1: a fixed pose
  double spread_mm = 0.0;
};

/// No point of S comes farther than this beyond the border of a half-space of material. mm.
double beyond_plane_mm(const ConvexCell& s, const Chord& chord, const HalfSpace& material);

/// S and K are no deeper in each other than this, by directions in K that go straight from n[0] to
/// n[1], unit vectors, while S goes along the chord (README, section 11). mm; infinity where both
/// are opposite.
double beyond_turning_mm(const ConvexCell& s, const ConvexCell& k, const Chord& chord,
                         const Vec3 (&n)[2]);

/// No point of S comes farther than this beyond the wall of a hole, where its height along the axis
/// is in `along_mm`; minus infinity: none gets there. Looks no closer once it is not above
/// limit_mm; infinity where it is seen to be above useless_mm. Adds what it has looked at to
/// `work`. places, unless null: points of S that come about so far, the farthest first, where some
/// are seen.
double beyond_wall_mm(const ConvexCell& s, const Chord& chord, const VoidWall& wall,
                      const Interval& along_mm, double limit_mm, double useless_mm,
                      std::uint64_t& work, std::vector<Vec3>* places);

}  // namespace mortise
