#pragma once
#include <optional>

#include "common/geometry/surface_band.h"
#include "common/math/interval.h"
#include "common/math/types.h"

namespace mortise {

/// Two round faces with parallel axes, whose axes may lie anywhere in zones of their own.
struct ParallelAxes {
  double apart_mm = 0.0;  ///< distance of the axes, as modelled
  bool nested = true;     ///< a shaft in a hole: farther apart is deeper; false: two shafts
};

/// The overlap of one region and what its two faces may be, drawn as a maker draws them: sizes and
/// places of axes. mm.
struct InterferenceZones {
  Interval certain_mm, possible_mm;  ///< overlap at the lower and at the upper offsets
  Interval size_a_mm, size_b_mm;     ///< outward offsets of the faces without their positions
  double position_a_mm = 0.0, position_b_mm = 0.0;  ///< diameters of the zones of their axes
  std::optional<ParallelAxes> axes;                 ///< needed where there is such a zone
};

/// Overlap of the modelled surfaces, as far as both layers bound it. Its ends are the wrong way
/// round where the tolerances explain more than the layers differ by.
Interval modelled_overlap_mm(const InterferenceZones& zones);

/// P(interference) of surfaces that are known but for their tolerances; sizes and both components
/// of a place are independent and normal with +-3 sigma at their limits (README, section 4). An
/// interval, since the overlap is known to a bracket. Nothing where no tolerance is declared, where
/// something else than the tolerances makes possible differ from certain, and for a position
/// without parallel axes. Ranks potential clashes, never changes a class. Without a position two
/// erfc, with one some 1,000 and 2,000 exponentials.
std::optional<Interval> interference_probability(const InterferenceZones& zones);

/// Is the surface of a deciding face known, up to its residual? Not by estimate, by a chord error
/// alone, or where the facets of something round are taken for it.
bool is_surface_known(const SurfaceBand::Face& face, FaceShape shape);

/// Two faces at their poses, where they meet, and the length over which they may.
struct MeetingFaces {
  const SurfaceBand::Face* a = nullptr;
  const SurfaceBand::Face* b = nullptr;
  Pose X_WA, X_WB;
  Vec3 at_W = Vec3::Zero();
  double length_mm = 0.0;
};

/// Nothing unless both are cylinders, a shaft at least one of them, no position grows with a size,
/// and over that length the axes stay as near to parallel as an overlap must be known.
std::optional<ParallelAxes> parallel_axes(const MeetingFaces& faces);

}  // namespace mortise
