#pragma once
#include <string>

#include "client/picture/detail_view.h"

namespace mortise {

/// A section of both parts to scale, round about the smaller one of them; in the axes of its plane.
struct Overview {
  std::string title;
  CutPlane plane;
  std::vector<std::vector<Vec2>> fills[2];  ///< closed outlines of A and B
  std::vector<std::vector<Vec2>> lines[2];
  Interval x_mm, y_mm;
};

Overview overview(const RegionQuery& query, const CutPlane& plane, const std::string& title);

}  // namespace mortise
