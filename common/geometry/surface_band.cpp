#include "common/geometry/surface_band.h"

namespace mortise {

Interval SurfaceBand::offset_mm(std::uint32_t triangle, const Vec3& x) const {
  const Face& face = face_of(triangle);
  if (!face.surface) return face.deviation_mm + face.tolerance_mm;
  // A mesh point inside the material lies as deep as the true surface stands outward of it.
  const double outward = -face.surface->signed_distance_mm(x);
  return Interval{outward - face.doubt_mm(), outward + face.doubt_mm()} + face.tolerance_mm;
}

SurfaceBand nominal_band() {
  SurfaceBand band;
  band.faces.emplace_back();
  return band;
}

}  // namespace mortise
