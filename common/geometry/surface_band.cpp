#include "common/geometry/surface_band.h"

#include <algorithm>

namespace mortise {

Interval SurfaceBand::offset_mm(std::uint32_t triangle, const Vec3& x) const {
  const Face& face = face_of(triangle);
  if (!face.surface) return face.deviation_mm + face.tolerance_mm;
  // A mesh point inside the material lies as deep as the true surface stands outward of it.
  const double outward = -face.surface->signed_distance_mm(x);
  return Interval{outward, outward} + face.doubt_mm() + face.tolerance_mm;
}

bool valid(const SurfaceBand& band, std::size_t triangles) {
  const FaceOfTriangle& face_of = band.face_of_triangle;
  return !band.faces.empty() && (face_of.empty() || face_of.size() == triangles) &&
         std::all_of(face_of.begin(), face_of.end(),
                     [&](std::uint16_t face) { return face < band.faces.size(); }) &&
         std::all_of(band.faces.begin(), band.faces.end(), [](const SurfaceBand::Face& face) {
           return face.deviation_mm.lo <= face.deviation_mm.hi &&
                  face.tolerance_mm.lo <= face.tolerance_mm.hi;
         });
}

}  // namespace mortise
