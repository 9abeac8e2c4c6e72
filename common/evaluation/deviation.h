#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/feature.h"
#include "common/geometry/solid.h"

namespace mortise {

/// A feature as it is declared, not yet matched to the mesh.
struct FeatureDeclaration {
  std::string name;
  Surface surface;
  std::optional<Interval> along_mm;  ///< extent along the axis from `point`; none: unbounded
  double chord_error_mm = 0.0;       ///< of the part; 0: none declared
};

/// A declared feature matched to the mesh. `note` says what was left out and why, or is empty.
struct FeatureMatch {
  Feature feature;
  std::string note;
};

/// Finds the triangles that stand for a declared surface: all corners near it, normal along it.
/// Near is max(2e-4 R, chord error); for a plane 2e-5 of the mesh radius. An error when none is
/// found, when the material is on the other side, or when the mesh contradicts the radius; the
/// error says which radius the mesh has about that axis. Facets far deeper than the others (a flat
/// cut whose corners lie on the round face) are left out and noted. residual_mm: largest distance
/// of a corner from the surface.
Result<FeatureMatch> match_feature(const TriangleMesh& mesh, const FeatureDeclaration& declared);

/// The same for known triangles (generated parts): only checks that their corners are near the
/// surface.
Result<FeatureMatch> check_feature(const Solid& solid, const FeatureDeclaration& declared,
                                   std::span<const std::uint32_t> triangles);

/// Shape of every triangle's face for a declared chord error s: kConvex or kConcave when it meets
/// neighbours smoothly that way only, kPlanar when no edge of its flat group can be smooth (a
/// smooth edge as bent as this one would need a larger chord error than s), else kUnknown.
std::vector<FaceShape> face_shapes(const Solid& solid, double chord_error_mm);

/// Where the surface may lie for a face of that shape: [0,s], [-s,0], 0, [-s,s].
Interval chord_deviation_mm(FaceShape shape, double chord_error_mm);

}  // namespace mortise
