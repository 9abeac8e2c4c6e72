#include "common/depth/cells/cover.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"
#include "common/depth/cells/cover_faces.h"
#include "common/depth/cells/cover_hollow.h"
#include "common/depth/cells/cover_outside.h"
#include "common/depth/cells/cover_prism.h"
#include "common/depth/cells/cover_profile.h"
#include "common/depth/cells/cover_voids.h"
#include "common/math/unit.h"

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

void check(const ConvexCell& cell) {
  for (const HalfSpace& face : cell.faces)
    MORTISE_CHECK(is_unit(face.n) && std::isfinite(face.c_mm),
                  "a face of a cell has a unit normal and a finite place");
  MORTISE_CHECK(cell.middle.allFinite(), "the middle of a cell is a point");
  if (!cell.round) return;
  MORTISE_CHECK(is_unit(cell.axis) && is_unit(cell.across[0]) && is_unit(cell.across[1]),
                "a round cell has unit directions");
  for (std::size_t i = 0; i < cell.circles.size(); ++i)
    MORTISE_CHECK(
        cell.circles[i].r_mm >= 0.0 && (i == 0 || cell.circles[i - 1].z_mm < cell.circles[i].z_mm),
        "the circles of a round cell ascend");
}

// What CoverLayer promises to those who bound a depth by it.
void check(const CoverLayer& layer) {
  for (const ConvexCell& cell : layer.cells) check(cell);
  for (const Void& v : layer.voids) {
    for (const VoidWall& wall : v.walls)
      MORTISE_CHECK(is_unit(wall.axis) && std::isfinite(wall.r_mm) && std::isfinite(wall.slope) &&
                        0.0 < wall.cosine && wall.cosine <= 1.0 + kUnitDirectionSlack,
                    "the wall of a void is a finite cylinder or cone");
    for (const HalfSpace& plane : v.planes)
      MORTISE_CHECK(is_unit(plane.n) && !std::isnan(plane.c_mm),
                    "a plane of a void has a unit normal");
  }
  MORTISE_CHECK(layer.heights_mm.size() == layer.cells.size() * layer.voids.size(),
                "a layer has heights of each cell beside each void");
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
    check(layer);
  }
  return cover;
}

const Cover& cover_of(const Body& body) {
  std::unique_ptr<const Cover>& cover = body.index().cover;
  if (!cover) cover = std::make_unique<const Cover>(find_cover(body));
  return *cover;
}

}  // namespace mortise
