#pragma once
#include <TopoDS_Shape.hxx>

#include "common/io/step/step_document.h"

namespace mortise {

struct MeshOptions {
  double chord_mm = 0.05;   ///< asked of the tessellation, and the target of freeform faces
  double angle_rad = 0.35;  ///< between neighbouring facets; decides the number of triangles
};

/// The solids of a shape as one part: triangles joined by the topology of the shape (never by
/// place), surfaces of the faces, exact volume, and what could not be had. The order of its faces
/// is that of `faces_of`. Freeform faces are refined until the measured deviation is within the
/// target, or as far as refining inside of triangles helps.
StepPart mesh_part(const TopoDS_Shape& solids, const MeshOptions& options);

/// The faces of all solids of a shape, in the order of StepPart::faces.
std::vector<TopoDS_Shape> faces_of(const TopoDS_Shape& solids);

}  // namespace mortise
