#include "common/broadphase/swept_box.h"

#include <cmath>

namespace mortise {
namespace {

// World axes, relative to the reference point of the motion.
Box rotated(const BodyBounds& body, const Mat3& R, const Vec3& reference_P) {
  const Vec3 center = R * (body.box_P.center() - reference_P);
  const Vec3 half = R.cwiseAbs() * body.box_P.half();
  Box box;
  box.lo = center - half;
  box.hi = center + half;
  return box;
}

}  // namespace

Box swept_box(const BodyBounds& body, const Motion& motion) {
  const Vec3& reference_P = motion.reference_P;
  const Vec3 c0 = motion.X_W0 * reference_P, c1 = motion.X_W1 * reference_P;
  const double radius = (body.sphere_P.center_mm - reference_P).norm() + body.sphere_P.radius_mm;
  if (motion.kind == PathKind::kScrew) {
    Box box = rotated(body, motion.X_W0.rotation(), reference_P);
    box.lo += c0;
    box.hi += c0;
    return box.grown(motion.travel_upper_bound_mm(radius, 0.0, 1.0));
  }
  // Relative to the reference point every body point runs along an arc of at most half a turn,
  // which lies within its sagitta of the chord between its ends.
  Box arms = rotated(body, motion.X_W0.rotation(), reference_P);
  if (motion.moves()) arms.add(rotated(body, motion.X_W1.rotation(), reference_P));
  arms = arms.grown(radius * (1.0 - std::cos(0.5 * motion.w_W.norm())));
  arms.lo = arms.lo.cwiseMax(Vec3::Constant(-radius));
  arms.hi = arms.hi.cwiseMin(Vec3::Constant(radius));
  Box box;
  box.lo = arms.lo + c0.cwiseMin(c1);
  box.hi = arms.hi + c0.cwiseMax(c1);
  return box;
}

}  // namespace mortise
