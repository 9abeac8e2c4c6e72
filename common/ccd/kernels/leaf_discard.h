#pragma once

// Which pairs of triangles of two leaves may be nearer than a given distance, all sixteen at once.
// Double precision, but it only discards: no number of an answer comes from here. No Eigen type:
// this header is compiled for different instruction sets, and no inline function of a library may
// come out of them.
namespace mortise::ccd {

/// Triangles of one leaf side by side, [corner][coordinate][triangle]; unused lanes repeat the
/// first. Axes of B from the origin of B's tree, mm.
struct alignas(32) FourTriangles {
  double corner[3][3][4];
};

/// Where a leaf lies: x = r (corner - origin) + p.
struct Placement {
  double r[3][3], p[3], origin[3];
};

/// What is known of the nearest pair so far.
struct Reach {
  double mm = 0.0;             ///< pairs proven farther apart are discarded; may be infinite
  double n[3] = {0., 0., 0.};  ///< unit, from A to B, of the nearest pair so far; zero: none yet
};

/// Corners x y z one after another, `count` triangles from 1 to 4.
using PlaceLeaf = void (*)(const double* corners, int count, const Placement& placement,
                           FourTriangles& out);
/// The same, only moved by the origin of the tree of B.
using MoveLeaf = void (*)(const double* corners, int count, const double* origin,
                          FourTriangles& out);
/// Bit 4 i + j: triangle i of a and j of b may be within reach. About 80 ns with AVX2, 450 without.
using NearPairs = unsigned (*)(const FourTriangles& a, const FourTriangles& b, const Reach& reach);
/// Bit 4 i + j: likewise, along the direction reach.n alone. About 15 ns.
using NearAlong = NearPairs;

struct DiscardKernels {
  PlaceLeaf place;
  MoveLeaf move;
  NearPairs near_pairs;
  NearAlong near_along;
};

}  // namespace mortise::ccd
