#include "common/depth/depth.h"

#include "common/depth/body.h"
#include "common/depth/body_tips.h"

namespace mortise {

void make_body_ready(const Solid& solid, const SurfaceBand& band, int threads) {
  const auto faces = static_cast<std::uint16_t>(band.faces.size());
  for (int i = 0; i < threads; ++i) {
    {
      const Body body(solid, band);
      (void)body.face_of_child();
      (void)body.plane_faces();
      for (std::uint16_t face = 0; face < faces; ++face) (void)body.ends_of(face);
      (void)cover_of(body);
      (void)tips_of(body);
      // With it the room for those of all triangles: to touch so much memory takes a tick.
      if (!band.trivial) (void)body.sharp_neighbours(0);
    }
    lay_out_index(solid, band);
  }
}

}  // namespace mortise
