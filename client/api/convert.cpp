#include "client/api/convert.h"

#include <cmath>

#include "common/math/rotation.h"
#include "common/messages/names.h"

namespace mortise::api {

Error error_of(const mortise::Error& error) {
  switch (error.code) {
    case mortise::Code::kInvalidInput:
      return {Code::kInvalidInput, error.text};
    case mortise::Code::kNotFound:
      return {Code::kNotFound, error.text};
    case mortise::Code::kUnsupported:
      return {Code::kUnsupported, error.text};
    case mortise::Code::kLimit:
      return {Code::kLimit, error.text};
    case mortise::Code::kMismatch:
      return {Code::kMismatch, error.text};
    case mortise::Code::kRuntime:
      break;
  }
  return {Code::kRuntime, error.text};
}

Interval interval_of(const mortise::Interval& interval) { return {interval.lo, interval.hi}; }

Pose pose_of(const mortise::Pose& X) {
  Pose out = Pose::Identity();
  out.linear() = X.q.toRotationMatrix();
  out.translation() = X.p;
  return out;
}

std::optional<mortise::Pose> pose_in(const Pose& X) {
  // Far above the rounding of a file with seven digits, far below what would be seen.
  constexpr double kSlack = 1e-6;
  const mortise::Mat3 R = X.linear();
  if (!X.matrix().allFinite() || R.determinant() <= 0.0) return std::nullopt;
  if (!((R.transpose() * R - mortise::Mat3::Identity()).cwiseAbs().maxCoeff() <= kSlack))
    return std::nullopt;
  const mortise::Pose pose{mortise::Quat(R).normalized(), X.translation()};
  if (!mortise::valid(pose)) return std::nullopt;
  return pose;
}

PushInPlace push_about(const mortise::Pose& dX_W, const Vec3& point_W) {
  return {dX_W * point_W - point_W, mortise::rotation_log(dX_W.q)};
}

Clash clash_of(const mortise::Verdict& v, const ClashNames& names) {
  Clash clash;
  clash.part_a = names.part_a;
  clash.part_b = names.part_b;
  clash.collision_class = static_cast<CollisionClass>(v.collision_class);
  clash.depth_mm = interval_of(v.delta_mm);
  clash.way_out_mm = interval_of(v.gpd_mm);
  clash.fake_up_to_mm = v.fake_below_mm;
  clash.real_above_mm = v.real_above_mm;
  clash.margin_mm = v.margin_mm;
  if (mortise::has_probability(v)) clash.probability = v.probability;
  clash.point_W = v.point_W;
  clash.normal_W = v.normal_W;
  clash.area_mm2 = v.area_mm2;
  if (v.has_witness) clash.witness_W = v.witness_W;
  if (v.separation_way != mortise::SeparationWay::kNone)
    clash.way_out = WayOut{v.separation_of_b ? names.part_b : names.part_a,
                           v.separation_translation_mm,
                           v.separation_rotation_rad,
                           v.separation_about_W,
                           std::string(mortise::name_of(v.separation_way)),
                           std::string(mortise::name_of(v.separation_path)),
                           v.separation_blocker ? names.blocker : std::string()};
  clash.face_a = v.face_a;
  clash.face_b = v.face_b;
  clash.grade = mortise::name_of(v.grade);
  clash.explanation = v.explanation;
  return clash;
}

std::string name_of(CollisionClass value) {
  return std::string(mortise::name_of(static_cast<mortise::CollisionClass>(value)));
}

std::string name_of(FirstContact::State value) {
  switch (value) {
    case FirstContact::State::kFree:
      return "free";
    case FirstContact::State::kContact:
      return "contact";
    case FirstContact::State::kTouchingAtStart:
      return "touching_at_start";
    case FirstContact::State::kOverlappingAtStart:
      return "overlapping_at_start";
    case FirstContact::State::kUndecided:
      break;
  }
  return "undecided";
}

}  // namespace mortise::api
