#pragma once
#include <cstddef>
#include <vector>

#include "common/math/types.h"

/// Simple polygons in a plane, counter-clockwise, mm.
namespace mortise::outline {

/// {x : n · x <= c}, n a unit vector.
struct Line {
  Vec2 n = Vec2::UnitX();
  double c_mm = 0.0;
};
/// Unit, to the right of the way from a to b.
Vec2 outward(const Vec2& a, const Vec2& b);

double area(const std::vector<Vec2>& corners);
/// Of x from the straight way from a to b.
double distance(const Vec2& x, const Vec2& a, const Vec2& b);
/// Is the straight way from a to b in the polygon, or outside by no more than slack_mm? Negative:
/// inside, and so far from its border. O(corners).
bool is_within(const std::vector<Vec2>& corners, const Vec2& a, const Vec2& b, double slack_mm);

/// A corner of a convex piece, and the side of the polygon that begins at it: or a cut.
struct Corner {
  static constexpr std::size_t kCut = static_cast<std::size_t>(-1);
  Vec2 at = Vec2::Zero();
  std::size_t side = kCut;
  std::size_t beyond = kCut;  ///< of a cut: the piece beyond it
  bool is_cut() const { return side == kCut; }
};
using Piece = std::vector<Corner>;

/// Convex pieces that are the polygon together; each side is of one of them. Cuts go from one
/// hollow corner to the next. Empty: such cuts do not do. O(corners²).
std::vector<Piece> convex_pieces(const std::vector<Vec2>& corners, double same_mm);

/// The convex polygon within all lines, which must bound it; empty: there is none.
std::vector<Vec2> within(const std::vector<Line>& lines);

}  // namespace mortise::outline
