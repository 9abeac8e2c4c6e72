#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "client/picture/canvas.h"
#include "client/picture/detail_view.h"
#include "client/picture/overview.h"

namespace mortise {

/// Colours of part A and part B, and of the classes.
Color color_of_part(int part);
Color color_of(CollisionClass collision_class);
inline constexpr Color kInk{0.13, 0.13, 0.15}, kGrey{0.45, 0.45, 0.48};

/// 0xRRGGBB.
Color color_of_hex(std::uint32_t hex);

/// Maps a window of the world to the sheet. Up stays up.
struct Frame {
  Box2 box;
  Interval x_mm, y_mm;
  Vec2 operator()(const Vec2& x) const {
    return {box.x + (x.x() - x_mm.lo) / x_mm.width() * box.width,
            box.bottom() - (x.y() - y_mm.lo) / y_mm.width() * box.height};
  }
  std::vector<Vec2> operator()(const std::vector<Vec2>& points) const {
    std::vector<Vec2> drawn;
    drawn.reserve(points.size());
    for (const Vec2& x : points) drawn.push_back((*this)(x));
    return drawn;
  }
};

/// The section near the deciding point with its zones, dimensions and scales; the legend below it.
void draw_detail(Canvas& canvas, const Box2& box, const DetailView& view, const Verdict& verdict);

/// Which way the deciding point sets off when its part is moved out, as the plane shows it (x
/// right, y up, length 1); none where it mostly leaves the plane.
std::optional<Vec2> way_seen(const CutPlane& plane, const Verdict& verdict);

/// A section to scale, with a mark where the detail is.
void draw_overview(Canvas& canvas, const Box2& box, const Overview& view);

/// The overlap of the meshes between the two thresholds, on one line.
void draw_thresholds(Canvas& canvas, const Box2& box, const Verdict& verdict);

/// A bar of a round length, about `share` of the width at most.
void draw_scale_bar(Canvas& canvas, const Frame& frame, double share);

}  // namespace mortise
