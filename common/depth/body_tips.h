#pragma once
#include <memory>
#include <vector>

#include "common/depth/body.h"

namespace mortise {

/// The tips of the largest part (geometry/tips.h); found once, O(triangles).
inline const std::vector<Tip>& tips_of(const Body& body) {
  std::unique_ptr<const std::vector<Tip>>& tips = body.index().tips;
  if (!tips) tips = std::make_unique<const std::vector<Tip>>(find_tips(*body.solid, *body.band));
  return *tips;
}

}  // namespace mortise
