#pragma once
#include "tests/bench/judgement_oracle.h"
#include "tests/bench/judgement_program.h"

/// Pairs of convex polyhedra whose plane faces have random tolerance bands, and their truth: a
/// sharp offset body of a convex part is the intersection of its offset half-spaces, so linear
/// programs decide.
namespace mortise::bench {

struct ConvexPart {
  struct Face {
    HalfSpace at;  ///< as modelled, part frame
    Interval offset_mm;
    std::vector<std::uint32_t> corners;  ///< counter-clockwise from outside
  };
  std::vector<Vec3> points_mm;
  std::vector<Face> faces;
  bool by_face = false;  ///< each face has a statement of its own

  /// Half-spaces with the faces at a share of their zones: 0 least, 1 largest; none: as modelled.
  std::vector<HalfSpace> half_spaces(const Pose& X_BP, std::optional<double> share) const;
};

/// Hull of at most some dozens of points, about which the origin lies; coplanar corners make one
/// face. Faces have no offsets.
ConvexPart convex_hull(const std::vector<Vec3>& points_mm);

/// How far a corner moves when each of its faces is offset by a band, over what the farthest of
/// them moves: largest over corners, layers and an equal offset of all.
double worst_travel(const ConvexPart& part);

/// The pair of a seed: the same on every run.
OracleCase draw_convex(std::uint64_t seed);

}  // namespace mortise::bench
