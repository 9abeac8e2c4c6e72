#pragma once
#include <optional>
#include <span>
#include <vector>

#include "common/evaluation/tolerance.h"
#include "common/geometry/given_part.h"
#include "common/geometry/solid.h"
#include "common/geometry/surface_band.h"

namespace mortise {

/// All that is known of one part's surface.
struct BandInput {
  const Solid* solid = nullptr;
  std::span<const Feature> features;  ///< matched; a triangle belongs to one feature at most
  std::optional<double> chord_error_mm;
  FaceStatement rest;                     ///< every face without a statement of its own
  std::vector<FaceStatement> of_feature;  ///< by feature
  bool estimate = false;  ///< the rest by estimate (grade kEstimated); a chord error goes before it
  double quantum_mm = 0.0;  ///< rounding of each coordinate in the file (README, section 1)
  /// Of the rest: triangles whose deviation was measured (grade kEstimated); of no feature.
  std::span<const FreeformFace> freeform = {};
};

/// faces[0] is the rest of the part, faces[1 + i] feature i. With a declared chord error the rest
/// is split by shape into further faces behind them, with an estimate by its size. What may be flat
/// of a recognized feature (see roundness.h) is one of these further faces, with the feature's name
/// and statements. Triangles and topology are used only when something is declared.
SurfaceBand build_band(const BandInput& input);

/// The same faces of the solid under other statements, for a pair with its own fit.
SurfaceBand with_statements(const SurfaceBand& band, const Solid& solid, const FaceStatement& rest,
                            std::span<const FaceStatement> of_feature);

/// All faces of the band farther out, by so much (mm, >= 0).
SurfaceBand grown(const SurfaceBand& band, const Solid& solid, double by_mm);

}  // namespace mortise
