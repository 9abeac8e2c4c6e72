#include "common/depth/search/known_depth.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/depth/search/face_pair.h"

namespace mortise {
namespace {

// A round face of S or K in a hollow one, and where the patch is along the axis of that.
struct HereAlongHollow {
  const Surface* of[2];  // of A, of B
  int hollow;
  FaceExtent along;
};

std::optional<HereAlongHollow> along_hollow(const DepthProof& proof, const Patch& patch,
                                            const KnownOverlaps::Row& row) {
  HereAlongHollow here{};
  for (int i = 0; i < 2; ++i)
    here.of[i] = &*(i == proof.role ? *proof.s : *proof.k).band->faces[row.face[i]].surface;
  if (here.of[0]->inward == here.of[1]->inward) return std::nullopt;
  here.hollow = here.of[0]->inward ? 0 : 1;
  const Surface& hollow = *here.of[here.hollow];
  const Pose X_KS = proof.role == 0 ? *proof.known->X_BA : proof.known->X_BA->inverse();
  const bool in_k = here.hollow != proof.role;
  const Vec3 point = in_k ? hollow.point : Vec3(X_KS * hollow.point);
  const Vec3 axis = in_k ? hollow.axis : Vec3(X_KS.q * hollow.axis);
  here.along.lo_mm = kInfinity;
  here.along.hi_mm = -kInfinity;
  for (int i = 0; i < patch.count; ++i) {
    const double z = (patch.points[i] - point).dot(axis);
    here.along.lo_mm = std::min(here.along.lo_mm, z);
    here.along.hi_mm = std::max(here.along.hi_mm, z);
  }
  return here;
}

// Row::within_mm where the patch is: a tilted shaft comes nearer to its bore elsewhere, and a ball
// to its socket.
double within_here(const DepthProof& proof, const Patch& patch, const KnownOverlaps::Row& row) {
  if (!proof.known->X_BA) return kInfinity;
  const auto here = along_hollow(proof, patch, row);
  if (!here) return kInfinity;
  const Surface &a = *here->of[0], &b = *here->of[1];
  const Pose& X_BA = *proof.known->X_BA;
  const double margin_mm = patch.thickness() + proof.rounding_mm;
  const FaceExtent none, &along_a = here->hollow == 0 ? here->along : none,
                         &along_b = here->hollow == 1 ? here->along : none;
  if (a.kind == SurfaceKind::kCylinder && is_round_in_bore(a, b))
    return in_bore_bound({&a, &b, along_a, along_b, 0.0, margin_mm}, X_BA).within_mm;
  if (a.kind != SurfaceKind::kSphere || b.kind != SurfaceKind::kSphere) return kInfinity;
  // With the radii of the layer: at a rim both are not offset alike.
  const int ball = 1 - here->hollow;
  const auto offset = [&](int i) {
    const Body& body = i == proof.role ? *proof.s : *proof.k;
    return Body::offset_of(body.band->faces[row.face[i]], proof.layer);
  };
  Surface round = *here->of[ball], socket = *here->of[here->hollow];
  round.radius_mm += offset(ball);
  socket.radius_mm -= offset(here->hollow);
  round.point = ball == 0 ? Vec3(X_BA * round.point) : Vec3(X_BA.inverse() * round.point);
  const double offsets = offset(0) + offset(1);
  if (here->hollow != proof.role) {
    const auto overlap = face_pair_overlap(round, none, socket, here->along, Pose(), margin_mm);
    return overlap ? overlap->near_hi_mm - offsets : kInfinity;
  }
  const auto beyond = beyond_socket(round, socket, here->along, margin_mm);
  return beyond ? beyond->depth_mm - offsets : kInfinity;
}

// Is the patch between the ends of the row's convex face?
bool keeps_within(const DepthProof& proof, const Patch& patch, const KnownOverlaps::Row& row) {
  const Interval& extent = row.within_extent_mm;
  if (!std::isfinite(extent.lo)) return true;
  const Surface& of_s = *proof.s->band->faces[row.face[proof.role]].surface;
  const Surface& of_k = *proof.k->band->faces[row.face[1 - proof.role]].surface;
  const auto is_between = [&](const Surface& convex, const Vec3& x) {
    const double z = (x - convex.point).dot(convex.axis);
    return z >= extent.lo - proof.rounding_mm && z <= extent.hi + proof.rounding_mm;
  };
  if (!of_s.inward) {
    for (int i = 0; i < 3; ++i)
      if (!is_between(of_s, proof.s->mesh->corner(proof.triangle_s, i))) return false;
    return true;
  }
  for (int i = 0; i < patch.count; ++i)
    if (!is_between(of_k, patch.points[i])) return false;
  return true;
}

// Does the row speak of K's surface wherever the patch is?
bool holds_along(const DepthProof& proof, const Patch& patch, const KnownOverlaps::Row& row) {
  const Interval& along = row.holds_along_mm[1 - proof.role];
  if (!std::isfinite(along.lo)) return true;
  const Surface& of_k = *proof.k->band->faces[row.face[1 - proof.role]].surface;
  const double more = patch.thickness() + proof.rounding_mm;
  for (int i = 0; i < patch.count; ++i) {
    const double z = (patch.points[i] - of_k.point).dot(of_k.axis);
    if (z < along.lo + more || z > along.hi - more) return false;
  }
  return true;
}

// What one face of S, which the patch is of or ends on, is known to keep to.
KnownDepth depth_by_row(const DepthProof& proof, const Patch& patch, const KnownOverlaps::Row& row,
                        bool itself, double limit_mm) {
  KnownDepth known;
  known.along_mm = row.holds_along_mm[1 - proof.role];
  const bool convex = !proof.s->band->faces[row.face[proof.role]].surface->inward;
  if (itself) known.face_mm = row.overlap_mm;
  if (std::isfinite(row.within_mm) && keeps_within(proof, patch, row)) {
    known.face_mm = std::min(known.face_mm, row.within_mm);
    // A shaft is bounded wherever its face ends.
    if (!convex && !std::isfinite(row.within_extent_mm.lo)) known.continued_mm = row.within_mm;
  }
  if (itself && convex) known.continued_mm = std::min(known.continued_mm, row.along_mm);
  if (known.face_mm < known.continued_mm && holds_along(proof, patch, row))
    known.continued_mm = known.face_mm;
  if (known.continued_mm > limit_mm)
    known.continued_mm = std::min(known.continued_mm, within_here(proof, patch, row));
  known.face_mm = std::min(known.face_mm, known.continued_mm);
  return known;
}

}  // namespace

KnownDepth known_depth(const DepthProof& proof, const Patch& patch, std::uint32_t triangle_k) {
  const Body& s = *proof.s;
  const std::uint16_t face_k = proof.k->face_index(triangle_k);
  const double offset_k = Body::offset_of(proof.k->face(triangle_k), proof.layer);
  KnownDepth least;
  const auto bound = [&](std::uint32_t t, bool itself) {
    const KnownOverlaps::Row* row = proof.known->find(proof.role, s.face_index(t), face_k);
    if (row == nullptr) return;
    const double offsets = offset_k + Body::offset_of(s.face(t), proof.layer);
    const KnownDepth by_row = depth_by_row(proof, patch, *row, itself, proof.limit_mm - offsets);
    if (by_row.face_mm + offsets < least.face_mm) {
      least.face_mm = by_row.face_mm + offsets;
      least.along_mm = by_row.along_mm;
    }
    least.continued_mm = std::min(least.continued_mm, by_row.continued_mm + offsets);
  };
  bound(proof.triangle_s, true);
  for (const std::uint32_t t : s.sharp_neighbours(proof.triangle_s)) bound(t, false);
  return least;
}

const KnownOverlaps::Row* KnownOverlaps::find(int role, std::uint16_t face_s,
                                              std::uint16_t face_k) const {
  for (const Row& row : rows)
    if (row.face[role] == face_s && row.face[1 - role] == face_k) return &row;
  return nullptr;
}

}  // namespace mortise
