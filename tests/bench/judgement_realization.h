#pragma once
#include <optional>

#include "tests/bench/judgement_cases.h"

namespace mortise::bench {

/// Real surfaces of one case, drawn inside their zones: constant, eccentric, lobed and tapered
/// shares of the zone, cut off at its limits.
struct DrawnSurface {
  Interval zone_mm;
  double level = 0.0;        ///< -1 .. 1: from one limit to the other
  double lobes_share = 0.0;  ///< of half the zone
  int lobes = 1;             ///< 1: eccentric
  double phase_rad = 0.0;
  double taper_share = 0.0;  ///< of half the zone, from one end to the other
  double rest_mm = 0.0;      ///< of ends and rims
  /// Outward offset at an angle about the axis and a height from -1 to 1.
  double offset_mm(double angle_rad, double height) const;
};
struct Realization {
  DrawnSurface a, b;
};

/// Draw number i of a case; the first four are the corners of both zones. Ends and rims move with
/// the level when the statement speaks of the whole part.
Realization draw_realization(const JudgedCase& c, bool whole, int i, Dice& dice);

/// Overlap of the drawn surfaces, mm, sampled densely over the inner part and again about the
/// best sample: never more than the true overlap, and less by about 1e-6 of the zone; of a shaft
/// tilted in the mouth of its hole by more, unless `to_ends` (ten times the work). Nothing for
/// planar families, whose extremes are the limits themselves.
std::optional<double> sampled_overlap_mm(const JudgedCase& c, const Realization& drawn,
                                         bool to_ends = false);

}  // namespace mortise::bench
