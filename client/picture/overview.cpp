#include "client/picture/overview.h"

#include <algorithm>

namespace mortise {
namespace {

// Room around the smaller part, as a share of its size.
constexpr double kRoom = 0.22;

struct Extent {
  Interval x, y;
  double size() const { return std::max(x.width(), y.width()); }
};

// Of all lines, with the origin.
Extent extent_of(const std::vector<CutLine>& lines) {
  Extent extent{{0.0, 0.0}, {0.0, 0.0}};
  for (const CutLine& line : lines)
    for (const Vec2& x : line.points) {
      extent.x = hull(extent.x, {x.x(), x.x()});
      extent.y = hull(extent.y, {x.y(), x.y()});
    }
  return extent;
}

}  // namespace

Overview overview(const RegionQuery& query, const CutPlane& plane, const std::string& title) {
  Overview view;
  view.title = title;
  view.plane = plane;
  Extent shown;
  for (int i = 0; i < 2; ++i) {
    const Part& part = *query.world->find(i == 0 ? query.a : query.b);
    const std::vector<CutLine> lines = cut_lines(part.solid->mesh(), part.X_WP, plane);
    for (const CutLine& line : lines)
      (line.closed ? view.fills[i] : view.lines[i]).push_back(line.points);
    const Extent extent = extent_of(lines);
    if (i == 0 || (extent.size() > 0.0 && extent.size() < shown.size())) shown = extent;
  }
  const double half = std::max((0.5 + kRoom) * shown.size(), 1e-3);
  view.x_mm = {shown.x.middle() - half, shown.x.middle() + half};
  view.y_mm = {shown.y.middle() - half, shown.y.middle() + half};
  return view;
}

}  // namespace mortise
