#include "common/geometry/border.h"

#include <algorithm>
#include <tuple>

namespace mortise {

std::vector<BorderEdge> border_of(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  struct Side {
    std::uint32_t low, high, triangle;
    bool forward;
  };
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = triangles[t][k], to = triangles[t][(k + 1) % 3];
      if (from != to) sides.push_back({std::min(from, to), std::max(from, to), t, from < to});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  std::vector<BorderEdge> border;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i;
    std::int32_t more = 0;
    for (; end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high;
         ++end)
      more += sides[end].forward ? 1 : -1;
    if (more != 0) {
      BorderEdge edge{sides[i].low, sides[i].high, more, 0};
      if (more < 0) edge = {sides[i].high, sides[i].low, -more, 0};
      for (std::size_t j = end; j-- > i;)
        if (sides[j].forward == (more > 0)) edge.triangle = sides[j].triangle;
      border.push_back(edge);
    }
    i = end;
  }
  return border;
}

}  // namespace mortise
