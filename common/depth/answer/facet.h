#pragma once
#include <array>
#include <cstdint>

#include "common/geometry/solid.h"

namespace mortise {

/// A box of space in the frame of a part: its middle and the half of each of its axes. mm.
struct SpaceBox {
  Vec3 center;
  std::array<Vec3, 3> half;
};

/// Does the plane of a triangle hold a foot of the surface under every point of the box? True: the
/// triangle and those that are flat beside it, no corner of which is farther from that plane than
/// `flat_mm`, cover the projection of the box on it. False: they do not, or too many would have to
/// be looked at. Exact but for the rounding of the files.
bool is_over_facet(const Solid& solid, std::uint32_t triangle, const SpaceBox& box, double flat_mm);

}  // namespace mortise
