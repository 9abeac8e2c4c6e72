#pragma once
#include <string>
#include <vector>

#include "common/evaluation/band.h"
#include "common/evaluation/deviation.h"
#include "common/evaluation/iso286.h"
#include "common/evaluation/tolerance.h"
#include "tests/support/shapes.h"

/// Bands of the parts that tests/support/shapes.h makes.
namespace mortise::shapes {

/// Cylinder along z through the origin, declared exactly; tolerance of it, none of the rest.
inline SurfaceBand cylinder_band(const SolidPtr& solid, double radius_mm, bool inward,
                                 Interval tolerance_mm, const std::string& source = "size") {
  FeatureDeclaration declared;
  declared.name = inward ? "bore" : "shaft";
  declared.surface.kind = SurfaceKind::kCylinder;
  declared.surface.radius_mm = radius_mm;
  declared.surface.inward = inward;
  const auto match = match_feature(solid->mesh(), declared);
  if (!match) return nominal_band();
  const std::vector<Feature> features = {match->feature};
  BandInput input;
  input.solid = solid.get();
  input.features = features;
  input.of_feature = {{tolerance_mm, source}};
  return build_band(input);
}

/// Every face alike: deviation of the mesh and tolerance.
inline SurfaceBand uniform_band(Interval deviation_mm, Interval tolerance_mm,
                                DeviationGrade grade = DeviationGrade::kDeclaredChord) {
  SurfaceBand band = nominal_band();
  SurfaceBand::Face& face = band.faces[0];
  face.deviation_mm = deviation_mm;
  face.tolerance_mm = tolerance_mm;
  face.grade = grade;
  band.trivial = false;
  band.largest_offset_mm = std::max(0.0, deviation_mm.hi + tolerance_mm.hi);
  return band;
}

/// Outward offsets of the two faces of "H7/g6" at a modelled radius.
struct FitOffsets {
  Interval hole_mm, shaft_mm;
};
inline FitOffsets fit_offsets(const std::string& code, double radius_mm) {
  const auto fit = iso286_fit(code, 2.0 * radius_mm);
  if (!fit) return {};
  return {size_offset_mm(fit->hole, radius_mm), size_offset_mm(fit->shaft, radius_mm)};
}

}  // namespace mortise::shapes
