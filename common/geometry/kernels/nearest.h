#pragma once

// What a search for the nearest triangle may pass over: eight boxes or four triangles at once. It
// may only discard. No Eigen type: this header is compiled for different instruction sets.
namespace mortise::geometry {

/// A point in single precision, from the origin of the tree, and what that and the differences may
/// be off, mm.
struct BoxPoint {
  float x[3], slack_mm;
};

/// A point in the part frame, and what is taken off a squared distance for what both are rounded
/// by, mm^2.
struct TrianglePoint {
  double x[3], slack2_mm2;
};

struct NearestKernels {
  /// distance2[k], mm^2: not above the squared distance of the point from box k, [coordinate][box].
  /// Bit k: that is not above limit2.
  unsigned (*boxes)(const BoxPoint& point, const float (*center)[8], const float (*half)[8],
                    float limit2, float* distance2);
  /// distance2[k], mm^2: not above the squared distance of the point from triangle k; corners of
  /// `count` triangles, 1 to 4, one after another. Beyond `count` that of triangle 0.
  void (*triangles)(const TrianglePoint& point, const double* corners, int count,
                    double* distance2);
};

/// Baseline instructions, on every machine.
const NearestKernels& portable_nearest();
/// The same operations in the same order on wider registers; null where they were not compiled or
/// the machine has none.
const NearestKernels* wide_nearest();
/// What this machine runs best. The answers are the same.
const NearestKernels& best_nearest();

}  // namespace mortise::geometry
