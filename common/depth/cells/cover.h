#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/depth/cells/convex_cell.h"
#include "common/math/interval.h"

namespace mortise {

struct Body;

/// The wall of a round hole: material only where r >= r_mm + slope * z, r the distance from the
/// axis and z the height above `point`; of a socket r that from `point`. Part frame, mm.
struct VoidWall {
  bool is_socket = false;
  Vec3 point = Vec3::Zero(), axis = Vec3::UnitZ();
  double r_mm = 0.0, slope = 0.0;
  double cosine = 1.0;  ///< of the angle between wall and axis
  /// Not whole: of a cylinder. The hole reaches to its tangents there, and is round between them;
  /// r is the way from the axis along that direction of these in which it is longest.
  Arc arc;
  /// Material that is beside the wall, and beyond no plane of the hole, has these heights.
  Interval along_mm{-std::numeric_limits<double>::infinity(),
                    std::numeric_limits<double>::infinity()};
};

/// A convex part of space without material, open: a bore down to its floor, a pocket, a slot. The
/// material lies beyond one of `walls` or within one of `planes`.
struct Void {
  std::vector<VoidWall> walls;  ///< of one axis, and with the same heights
  std::vector<HalfSpace> planes;
};

/// One layer of a part lies in the union of `cells`, outside of all `voids`.
struct CoverLayer {
  std::vector<ConvexCell> cells;
  std::vector<Void> voids;
  /// By cell and void: the heights at which material of the cell may be beside a wall.
  std::vector<Interval> heights_mm;

  const Interval& heights_of(std::size_t cell, std::size_t v) const {
    return heights_mm[cell * voids.size() + v];
  }
};

/// Sets that the real part lies in, made of its faces moved by their own offsets (README, section
/// 11). They may be larger than the part, never smaller.
struct Cover {
  CoverLayer least, largest;
  std::string why_not;  ///< set: there is none

  bool found() const { return why_not.empty(); }
  const CoverLayer& of(bool is_least) const { return is_least ? least : largest; }
};

/// Cells from the round faces of the band and the plane faces of the mesh, checked against the
/// mesh. O(triangles * voids), once a part and band.
Cover find_cover(const Body& body);

/// The same, found once.
const Cover& cover_of(const Body& body);

}  // namespace mortise
