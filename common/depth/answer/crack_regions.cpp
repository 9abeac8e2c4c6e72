#include "common/depth/answer/crack_regions.h"

#include <algorithm>

#include "common/depth/answer/region_report.h"

namespace mortise {
namespace {

// A place of a lid, and whether the other part comes near it.
struct Meeting {
  Vec3 at_S = Vec3::Zero();
  std::uint32_t triangle_k = Topology::kNone;
};

// Pieces of a lid that are no larger than its reach, or than this share of it, are not cut.
constexpr double kLeastPiece = 1e-2;

// Piece by piece: no point of one is nearer to the other part than its middle less its radius.
Meeting meeting_of(const PairFrame& pair, int role, const Lid& lid, std::uint64_t& evaluations) {
  const Solid& other = *pair.k(role).solid;
  const double reach_mm = lid.reach_mm + pair.near_mm;
  const auto radius = [](const std::array<Vec3, 3>& t, const Vec3& middle) {
    return std::max({(t[0] - middle).norm(), (t[1] - middle).norm(), (t[2] - middle).norm()});
  };
  const auto middle_of = [](const std::array<Vec3, 3>& t) {
    return Vec3((t[0] + t[1] + t[2]) / 3);
  };
  const double least_mm =
      std::max(lid.reach_mm, kLeastPiece * radius(lid.corners, middle_of(lid.corners)));
  std::vector<std::array<Vec3, 3>> pieces{lid.corners};
  while (!pieces.empty()) {
    const std::array<Vec3, 3> t = pieces.back();
    pieces.pop_back();
    const Vec3 middle = middle_of(t);
    const double radius_mm = radius(t, middle);
    const SurfacePoint at = nearest_surface(other, pair.X_KS[role] * middle);
    ++evaluations;
    if (at.depth_mm < -(reach_mm + radius_mm)) continue;
    if (radius_mm <= least_mm) return {middle, at.triangle};
    int k = 0;  // the longest edge is cut
    for (int i = 1; i < 3; ++i)
      if ((t[(i + 1) % 3] - t[i]).norm() > (t[(k + 1) % 3] - t[k]).norm()) k = i;
    const Vec3 half = 0.5 * (t[k] + t[(k + 1) % 3]);
    pieces.push_back({t[k], half, t[(k + 2) % 3]});
    pieces.push_back({half, t[(k + 1) % 3], t[(k + 2) % 3]});
  }
  return {};
}

// What the other part meets in the crack is not known.
OverlapRegion region_at_crack(const PairFrame& pair, int role, const Meeting& meeting) {
  OverlapRegion region;
  const double depth = 2.0 * std::min(pair.bodies[0].solid->sphere().radius_mm,
                                      pair.bodies[1].solid->sphere().radius_mm);
  region.delta_mm = region.possible_mm = {0.0, depth};
  region.certain_mm = {-depth, 0.0};
  region.at_crack = true;
  region.point_W = pair.X_W[role] * meeting.at_S;
  const std::uint32_t own = nearest_point(*pair.s(role).solid, meeting.at_S).triangle;
  region.triangle_a = region.deciding_triangle_a = role == 0 ? own : meeting.triangle_k;
  region.triangle_b = region.deciding_triangle_b = role == 0 ? meeting.triangle_k : own;
  region.normal_W = pair.X_W[1].q * pair.bodies[1].normal(region.triangle_b);
  for (int i = 0; i < 2; ++i)
    (i == 0 ? region.shape_a : region.shape_b) =
        face_shape(pair.bodies[i], i == 0 ? region.triangle_a : region.triangle_b,
                   pair.X_W[i].inverse() * region.point_W);
  region.points_W = {region.point_W};
  return region;
}

void mark_cracks_of(const PairFrame& pair, int role, bool tell, OverlapResult& result) {
  const Cracks& cracks = pair.s(role).solid->cracks();
  if (!pair.s(role).has_inside || cracks.count == 0) return;
  const Pose X_SW = pair.X_W[role].inverse();
  bool told = false;
  for (OverlapRegion& region : result.regions) {
    if (!cracks.cover(X_SW * region.point_W) &&
        !(region.has_witness && cracks.cover(X_SW * region.witness_W)))
      continue;
    region.at_crack = told = true;
  }
  if (told || !tell) return;
  for (const Lid& lid : cracks.lids) {
    const Meeting meeting = meeting_of(pair, role, lid, result.evaluations);
    if (meeting.triangle_k == Topology::kNone) continue;
    result.regions.push_back(region_at_crack(pair, role, meeting));
    return;  // one is enough to say that not all is known
  }
}

}  // namespace

void mark_cracks(const PairFrame& pair, bool tell, OverlapResult& result) {
  for (int role = 0; role < 2; ++role) mark_cracks_of(pair, role, tell, result);
}

}  // namespace mortise
