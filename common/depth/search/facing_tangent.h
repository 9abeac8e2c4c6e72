#pragma once
#include "common/depth/search/patch.h"

namespace mortise {

/// How far the patch may reach below a convex round surface, mm: below its tangent plane where the
/// hull of the patch comes nearest to the axis, which for a flat patch is the least of all tangent
/// planes; on a cone its direction around the axis only. Infinite where the hull goes through the
/// axis.
double depth_below_facing_tangent(const Patch& patch, const Surface& surface);

}  // namespace mortise
