#pragma once
#include <BRepAdaptor_Surface.hxx>
#include <TopoDS_Face.hxx>
#include <optional>
#include <vector>

#include "common/geometry/feature.h"

namespace mortise {

/// The surface of a face as the file states it: plane, cylinder, cone, sphere or torus, with its
/// outward side by the orientation of the face. Nothing for another kind, and for a torus that
/// meets itself. `corners`: points of the face, which tell on which nappe of a cone it lies.
std::optional<Surface> stated_surface(const BRepAdaptor_Surface& adaptor, const TopoDS_Face& face,
                                      const std::vector<Vec3>& corners);

/// A freeform face that is one of these: fitted to points and normals of a grid, accepted where a
/// finer grid agrees within a few parts in a hundred thousand of its size. `gap_mm`: the largest
/// distance seen. Cost: some 300 evaluations.
struct RecognizedSurface {
  Surface surface;
  double gap_mm = 0.0;
};
std::optional<RecognizedSurface> recognized_surface(const BRepAdaptor_Surface& adaptor,
                                                    const TopoDS_Face& face);

}  // namespace mortise
