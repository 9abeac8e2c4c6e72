#pragma once
#include <mortise/judge.h>

#include <optional>
#include <string>

#include "common/base/result.h"
#include "common/math/interval.h"
#include "common/math/pose.h"
#include "common/messages/verdict.h"

/// Values of the house as those that other programs see, and back.
namespace mortise::api {

Error error_of(const mortise::Error& error);
Interval interval_of(const mortise::Interval& interval);
Pose pose_of(const mortise::Pose& X);

/// Nothing when it is no finite rigid motion.
std::optional<mortise::Pose> pose_in(const Pose& X);

/// Finite, and no coordinate beyond `most_mm`. (The largest coefficient of Eigen passes over NaN.)
inline bool is_within(const Vec3& x, double most_mm) {
  return x.allFinite() && x.cwiseAbs().maxCoeff() <= most_mm;
}

/// A push about the origin of the world as one about a point of the part.
struct PushInPlace {
  Vec3 translation_mm, rotation_rad;
};
PushInPlace push_about(const mortise::Pose& dX_W, const Vec3& point_W);

/// What names a verdict needs.
struct ClashNames {
  std::string part_a, part_b, blocker;
};
Clash clash_of(const mortise::Verdict& verdict, const ClashNames& names);

}  // namespace mortise::api
