#pragma once
#include "common/geometry/triangle_distance.h"

namespace mortise {

/// Whether two solid triangles cross. kDoubtful: touching, coplanar, or crossing by no more than
/// the tolerance and rounding.
enum class Meeting : std::uint8_t { kApart = 0, kCrossing, kDoubtful };

/// By the intervals that both cut out of the line in which their planes meet (Moeller 1997), each
/// widened by the rounding. kApart and kCrossing are certain.
Meeting meeting_of(const Triangle& a, const Triangle& b, double tolerance_mm);

}  // namespace mortise
