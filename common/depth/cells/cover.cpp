#include "common/depth/cells/cover.h"

#include <algorithm>

#include "common/depth/cells/cover_faces.h"
#include "common/depth/cells/cover_hollow.h"
#include "common/depth/cells/cover_outside.h"
#include "common/depth/cells/cover_prism.h"
#include "common/depth/cells/cover_profile.h"
#include "common/depth/cells/cover_voids.h"

namespace mortise {
namespace {

// A turned cover is taken that has less than this share of the volume of the box; prisms that have
// less than this share of what was best before. A profile is as close where it is but a little
// smaller: its corners are gone, or a flat is there.
constexpr double kSmaller = 0.95, kMuchSmaller = 0.99, kAnySmaller = 0.9999;

void set_heights(CoverLayer& layer) {
  for (const ConvexCell& cell : layer.cells)
    for (const Void& v : layer.voids) {
      Interval along;
      if (!v.walls.empty()) {
        const VoidWall& wall = v.walls.front();
        const double zero = wall.axis.dot(wall.point);
        along = {std::max(wall.along_mm.lo, -cell.support_mm(-wall.axis) - zero),
                 std::min(wall.along_mm.hi, cell.support_mm(wall.axis) - zero)};
      }
      layer.heights_mm.push_back(along);
    }
}

}  // namespace

Cover find_cover(const Body& body) {
  Cover cover;
  if (body.mesh->triangles.empty()) {
    cover.why_not = "it has no triangles";
    return cover;
  }
  if (!body.solid->inside_known()) {
    cover.why_not = "its mesh is open: what is inside is not known";
    return cover;
  }
  const CoverFaces faces(body);
  Outside outside = turned_outside(faces);
  Outside box = polytope_outside(faces);
  if (outside.cells[1].empty() || outside.volume_mm3 >= kSmaller * box.volume_mm3)
    outside = std::move(box);
  Outside prism = prism_outside(faces);
  if (!prism.cells[1].empty() && prism.volume_mm3 < kMuchSmaller * outside.volume_mm3)
    outside = std::move(prism);
  Outside profile = profile_outside(faces);
  if (!profile.cells[1].empty() && profile.volume_mm3 < kAnySmaller * outside.volume_mm3)
    outside = std::move(profile);
  if (outside.cells[1].empty()) {
    cover.why_not = "it is too thin";
    return cover;
  }
  std::vector<LayerVoids> voids = find_voids(faces);
  for (LayerVoids& hollow : find_hollows(faces)) voids.push_back(std::move(hollow));
  for (int i = 0; i < 2; ++i) {
    CoverLayer& layer = i == 0 ? cover.least : cover.largest;
    layer.cells = std::move(outside.cells[i]);
    for (const LayerVoids& v : voids) layer.voids.push_back(v.of[i]);
    set_heights(layer);
  }
  return cover;
}

const Cover& cover_of(const Body& body) {
  std::unique_ptr<const Cover>& cover = body.index().cover;
  if (!cover) cover = std::make_unique<const Cover>(find_cover(body));
  return *cover;
}

}  // namespace mortise
