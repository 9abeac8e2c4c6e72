#pragma once
#include <cstdint>
#include <vector>

#include "common/geometry/feature.h"
#include "common/geometry/solid.h"

namespace mortise {

/// Measures of one recognized feature in the mesh.
struct FeatureMeasure {
  std::uint32_t facets = 0;  ///< steps around the axis; sphere, plane: flat facets
  double arc_rad = 0.0;      ///< covered around the axis; 2 pi: closed. Plane: 0
  Interval along_mm;         ///< extent along surface.axis from surface.point
  double chord_error_mm =
      0.0;  ///< largest distance of a facet from the surface, sampled: the sagitta
  double area_mm2 = 0.0;
};

struct Recognition {
  /// Grade kRecognizedFeature (planes kPlanar), no triangle in two of them. Named and ordered:
  /// bore_1, ... (inward cylinders), shaft_1, ..., cone_, sphere_, torus_, plane_; within a kind
  /// closed ones first, then by falling size, then by place.
  std::vector<Feature> features;
  std::vector<FeatureMeasure> measures;  ///< same index
  std::uint64_t triangles_recognized = 0;
  std::uint64_t triangles_left = 0;     ///< triangles of no feature
  std::uint64_t doubtful_rows = 0;      ///< single rows of facets that may be steps of a curve
  std::uint64_t doubtful_planes = 0;    ///< flat facets that may be part of a curve
  double largest_residual_share = 0.0;  ///< largest residual / radius of a curved feature
};

struct RecognitionOptions {
  /// How far the file's coordinates are off for rounding (ImportReport::quantum_mm); 0: doubles.
  double quantum_mm = 0.0;
  bool planes = true;
  /// The slow twin: every set of seeds is fitted, also where a smaller one within it has failed,
  /// and every facet is tried at every share, in one thread. For tests.
  bool plain = false;
  /// At most; 0: as many as the machine runs. No more than three are used. The result is the same.
  /// Beside a session that runs one is enough.
  unsigned threads = 1;
};

/// Planes, cylinders, cones, spheres and tori of a mesh whose corners lie on the true surfaces, by
/// growing over smooth edges (exterior angle up to kSmoothEdge_rad) from fits of few facets.
///
/// Accepted with all corners within 1e-6 R (plus rounding of the file) where the mesh allows it,
/// else within 1.4e-5 R, else within 2e-4 R: corners of published bores are up to 1.5e-4 R off. The
/// residual reached is in Feature::residual_mm, and bands carry it on both sides.
///
/// Only corners and facet normals are known. A prism whose flats turn by 35 degrees or less and
/// whose corners lie on a circle is found as round: twelve flats are, six and eight are not.
/// Whether a facet may be taken for round is another question (evaluation/roundness.h). A round
/// face needs three facets (two may be chamfers); a torus four strips, or three equal ones. A flat
/// whose corners lie on the round face is recognized by being three times as wide as the median
/// facet. A single row of facets between smooth neighbours may be a step of a drawn curve and is
/// left out, and so are flat facets that meet others smoothly; both are counted.
///
/// A sphere is accepted only where its facets cover enough of it for the sagitta of the arc to
/// exceed the residual clearly. Nearly flat regions are never spheres.
///
/// Deterministic, at any number of threads. 10 to 20 us of CPU for a triangle of a large part, less
/// where few faces are freeform.
Recognition recognize_features(const Solid& solid, const RecognitionOptions& options = {});

}  // namespace mortise
