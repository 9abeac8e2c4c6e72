#include "common/depth/known_depth.h"

#include <algorithm>
#include <cmath>

#include "common/depth/face_pair.h"

namespace mortise {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Row::within_mm of a shaft in a bore, where the patch is: a tilted shaft comes nearer elsewhere.
double within_here(const DepthProof& proof, const Patch& patch, const KnownOverlaps::Row& row) {
  if (!proof.known->X_BA) return kInfinity;
  const Surface* of[2];
  for (int i = 0; i < 2; ++i)
    of[i] = &*(i == proof.role ? *proof.s : *proof.k).band->faces[row.face[i]].surface;
  if (of[0]->kind != SurfaceKind::kCylinder || !is_round_in_bore(*of[0], *of[1])) return kInfinity;
  const int bore = of[0]->inward ? 0 : 1;
  const Pose& X_BA = *proof.known->X_BA;
  const Pose X_KS = proof.role == 0 ? X_BA : X_BA.inverse();
  const bool bore_in_k = bore != proof.role;
  const Vec3 point = bore_in_k ? of[bore]->point : Vec3(X_KS * of[bore]->point);
  const Vec3 axis = bore_in_k ? of[bore]->axis : Vec3(X_KS.q * of[bore]->axis);
  InBoreQuery query{of[0], of[1], {}, {}, 0.0, patch.thickness() + proof.rounding_mm};
  FaceExtent& along = bore == 0 ? query.extent_a : query.extent_b;
  along.lo_mm = kInfinity;
  along.hi_mm = -kInfinity;
  for (int i = 0; i < patch.count; ++i) {
    const double z = (patch.points[i] - point).dot(axis);
    along.lo_mm = std::min(along.lo_mm, z);
    along.hi_mm = std::max(along.hi_mm, z);
  }
  return in_bore_bound(query, X_BA).within_mm;
}

// Is the patch between the heights for which the row speaks?
bool keeps_within(const DepthProof& proof, const Patch& patch, const KnownOverlaps::Row& row) {
  const Interval& extent = row.within_extent_mm;
  if (!std::isfinite(extent.lo)) return true;
  const Surface& of_s = *proof.s->band->faces[row.face[proof.role]].surface;
  const Surface& of_k = *proof.k->band->faces[row.face[1 - proof.role]].surface;
  const auto is_between = [&](const Surface& surface, const Vec3& x) {
    const double z = (x - surface.point).dot(surface.axis);
    return z >= extent.lo - proof.rounding_mm && z <= extent.hi + proof.rounding_mm;
  };
  const bool along_hollow = of_s.kind == SurfaceKind::kSphere;
  if (of_s.inward == along_hollow) {
    for (int i = 0; i < 3; ++i)
      if (!is_between(of_s, proof.s->mesh->corner(proof.triangle_s, i))) return false;
    return true;
  }
  for (int i = 0; i < patch.count; ++i)
    if (!is_between(of_k, patch.points[i])) return false;
  return true;
}

}  // namespace

double known_depth_mm(const DepthProof& proof, const Patch& patch, std::uint32_t triangle_k) {
  const Body& s = *proof.s;
  const std::uint16_t face_k = proof.k->face_index(triangle_k);
  const double offset_k = Body::offset_of(proof.k->face(triangle_k), proof.layer);
  double least = kInfinity;
  const auto bound = [&](std::uint32_t t, bool itself) {
    const KnownOverlaps::Row* row = proof.known->find(proof.role, s.face_index(t), face_k);
    if (row == nullptr) return;
    const bool within = std::isfinite(row->within_mm) && keeps_within(proof, patch, *row);
    double overlap =
        std::min(itself ? row->overlap_mm : kInfinity, within ? row->within_mm : kInfinity);
    const double offset = Body::offset_of(s.face(t), proof.layer);
    if (overlap + offset + offset_k > proof.limit_mm)
      overlap = std::min(overlap, within_here(proof, patch, *row));
    least = std::min(least, overlap + offset);
  };
  bound(proof.triangle_s, true);
  for (const std::uint32_t t : s.sharp_neighbours(proof.triangle_s)) bound(t, false);
  return least + offset_k;
}

const KnownOverlaps::Row* KnownOverlaps::find(int role, std::uint16_t face_s,
                                              std::uint16_t face_k) const {
  for (const Row& row : rows)
    if (row.face[role] == face_s && row.face[1 - role] == face_k) return &row;
  return nullptr;
}

}  // namespace mortise
