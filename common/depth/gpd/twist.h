#pragma once
#include "common/geometry/solid.h"
#include "common/math/pose.h"

// Motions of one part with a constant twist: X(s) = exp(s ξ), s from 0 to 1.
namespace mortise::gpd {

using Vec6 = Eigen::Matrix<double, 6, 1>;

/// Twists of a part are written about the centre of its bounding sphere, the turn as the path that
/// it gives a point at the radius of the sphere: ξ = (v, R w), six lengths in mm. World axes.
struct TwistFrame {
  Vec3 center_W = Vec3::Zero();
  double radius_mm = 1.0;

  TwistFrame() = default;
  TwistFrame(const Solid& part, const Pose& X_W);

  Vec3 turn_of(const Vec6& xi) const { return xi.tail<3>() / radius_mm; }
  /// exp(ξ), which acts on points of the world. Any turn.
  Pose pose_of(const Vec6& xi) const;
  /// The twist of no more than half a turn that ends in the pose.
  Vec6 twist_of(const Pose& X) const;
  /// Velocity of a point when the motion begins; its size is the same all along the way.
  Vec3 velocity_of(const Vec6& xi, const Vec3& x_W) const {
    return Vec3(xi.head<3>()) + turn_of(xi).cross(x_W - center_W);
  }
};

inline Vec6 translation_twist(const Vec3& t) {
  Vec6 xi;
  xi << t, Vec3::Zero();
  return xi;
}

/// Longest path of any point of the part, mm: largest of |v + w x (p - c)| over all of its corners
/// (README, section 7), by way of its tree. Never short, and long by 1e-9 of it at most.
double longest_path_mm(const Solid& part, const Pose& X_W, const TwistFrame& frame, const Vec6& xi);

/// The slow twin: looks at every corner.
double longest_path_brute_force_mm(const Solid& part, const Pose& X_W, const TwistFrame& frame,
                                   const Vec6& xi);

}  // namespace mortise::gpd
