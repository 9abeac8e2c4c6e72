#pragma once
#include <BRepAdaptor_Surface.hxx>
#include <TopoDS_Face.hxx>
#include <array>
#include <cstdint>
#include <vector>

#include "common/math/interval.h"
#include "common/math/types.h"

namespace mortise {

/// The triangles of one face with the parameters of their corners, outward.
struct FreeformMesh {
  std::vector<Vec3> points;
  std::vector<std::array<double, 2>> uv;  ///< empty: not known
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct FreeformDeviation {
  bool known = false;
  Interval outward_mm;  ///< surface minus mesh, as sampled and widened by kSamplesMiss
};

/// Samples may miss the largest deviation of a triangle by this share of it.
inline constexpr double kSamplesMiss = 0.25;

/// Splits triangles whose deviation exceeds the target at points of the surface inside of them (so
/// that no edge is touched), in a few rounds, and measures what is reached at 15 points a triangle,
/// each improved by Gauss-Newton to the nearest point of the surface.
FreeformDeviation refine_freeform(const BRepAdaptor_Surface& adaptor, const TopoDS_Face& face,
                                  double target_mm, FreeformMesh& mesh);

}  // namespace mortise
