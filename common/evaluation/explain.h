#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "common/evaluation/verdict.h"
#include "common/geometry/surface_band.h"

namespace mortise {

/// One sentence that explains the class: overlap, thresholds, what determined each, margin.
struct ExplainInput {
  CollisionClass collision_class = CollisionClass::kNone;
  Interval delta_mm;
  Thresholds thresholds;
  double margin_mm = 0.0;
  const SurfaceBand::Face* face_a = nullptr;
  const SurfaceBand::Face* face_b = nullptr;
  Interval tolerance_mm;  ///< sum of both
  DeviationGrade grade = DeviationGrade::kUnknown;
  std::optional<Interval> probability;  ///< of potential, where it is known
  bool no_inside = false;
  bool at_crack = false;
  bool capped = false;
  bool estimated = false;               ///< a face that was used is known by estimate only
  std::uint64_t witnesses_refused = 0;  ///< points taken for inside both that a mesh denies
  /// False: the class was decided before this threshold was; it is left out,
  /// but for the one that the class rests on.
  bool fake_known = true, real_known = true;
  std::string fit;  ///< "Ø20 H7/g6" when the pair has one
};
std::string explain(const ExplainInput& input);

}  // namespace mortise
