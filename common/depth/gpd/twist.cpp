#include "common/depth/gpd/twist.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/bvh/bvh_support.h"
#include "common/math/rotation.h"

namespace mortise::gpd {
namespace {

// Boxes that may hold a point that is faster by no more than this share are left alone.
constexpr double kTwistSlack = 1e-9;
// Below this turn, rad, the series of the coefficients of exp are exact to rounding.
constexpr double kSmallTurn_rad = 1e-3;

// t = V v: where the centre comes to, V = 1 + f [w] + g [w]², f = (1 - cos a) / a²,
// g = (a - sin a) / a³.
struct Coefficients {
  double f = 0.5, g = 1.0 / 6.0;
  Coefficients(double a, const Quat& q) {
    if (a < kSmallTurn_rad) {
      f = 0.5 - a * a / 24.0;
      g = 1.0 / 6.0 - a * a / 120.0;
      return;
    }
    const double sine = q.vec().norm(), cosine = q.w();  // of half the turn
    f = 2.0 * sine * sine / (a * a);
    g = (a - 2.0 * sine * cosine) / (a * a * a);
  }
};

// Velocity b + W x of a point x of the tree (part axes, from its origin).
struct Field {
  Vec3 b, w;
  Vec3 at(const Vec3& x) const { return b + w.cross(x); }
  /// No point in the box of a child is faster, squared: by the box of velocities about its middle.
  void bounds2(const Bvh::Node& node, double (&most2)[Bvh::kWidth]) const {
    for (int k = 0; k < Bvh::kWidth; ++k) {
      const double x = node.local_center[0][k], y = node.local_center[1][k],
                   z = node.local_center[2][k], hx = node.half[0][k], hy = node.half[1][k],
                   hz = node.half[2][k];
      const double u = std::fabs(b[0] + w[1] * z - w[2] * y) + std::fabs(w[1]) * hz +
                       std::fabs(w[2]) * hy,
                   v = std::fabs(b[1] + w[2] * x - w[0] * z) + std::fabs(w[2]) * hx +
                       std::fabs(w[0]) * hz,
                   s = std::fabs(b[2] + w[0] * y - w[1] * x) + std::fabs(w[0]) * hy +
                       std::fabs(w[1]) * hx;
      most2[k] = u * u + v * v + s * s;
    }
  }
};

}  // namespace

TwistFrame::TwistFrame(const Solid& part, const Pose& X_W)
    : center_W(X_W * part.sphere().center_mm),
      radius_mm(part.sphere().radius_mm > 0.0 ? part.sphere().radius_mm : 1.0) {}

Pose TwistFrame::pose_of(const Vec6& xi) const {
  const Vec3 v = xi.head<3>(), w = turn_of(xi);
  const Quat q = rotation_exp(w);
  const Coefficients k(w.norm(), q);
  const Vec3 wv = w.cross(v);
  const Vec3 t = v + k.f * wv + k.g * w.cross(wv);
  return {q, center_W + t - q * center_W};
}

Vec6 TwistFrame::twist_of(const Pose& X) const {
  const Vec3 w = rotation_log(X.q.normalized());
  const Vec3 t = X * center_W - center_W;
  const double a = w.norm();
  // V⁻¹ = 1 - [w]/2 + h [w]², h = 1/a² - (1 + cos a) / (2 a sin a) = (1 - f' a² / (2 g')) / a²
  double h = 1.0 / 12.0;
  if (a >= kSmallTurn_rad) {
    const Quat q = rotation_exp(w);
    const double sine = q.vec().norm(), cosine = q.w();
    h = (1.0 - 0.5 * a * cosine / sine) / (a * a);
  } else {
    h += a * a / 720.0;
  }
  const Vec3 wt = w.cross(t);
  Vec6 xi;
  xi << t - 0.5 * wt + h * w.cross(wt), radius_mm * w;
  return xi;
}

double longest_path_mm(const Solid& part, const Pose& X_W, const TwistFrame& frame,
                       const Vec6& xi) {
  const Vec3 v_W = xi.head<3>();
  if (xi.tail<3>().isZero(0.0)) return v_W.norm();
  const Bvh& bvh = part.bvh();
  const Quat back = X_W.q.conjugate();
  const Field field{back * frame.velocity_of(xi, X_W * bvh.origin), back * frame.turn_of(xi)};
  double most2 = 0.0;
  for (const Vec3& x : part.outline().corners)
    most2 = std::max(most2, field.at(x - bvh.origin).squaredNorm());
  constexpr double kSlack2 = (1.0 + kTwistSlack) * (1.0 + kTwistSlack);
  std::int32_t stack[Bvh::kMostWaiting];
  int top = 0;
  stack[top++] = bvh.root;
  while (top > 0) {
    const std::int32_t child = stack[--top];
    if (child < 0) {
      const Bvh::Leaf& leaf = bvh.leaves[~child];
      for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i)
        for (int k = 0; k < 3; ++k)
          most2 = std::max(most2, field.at(bvh_corner(bvh, i, k)).squaredNorm());
      continue;
    }
    const Bvh::Node& node = bvh.nodes[child];
    double child2[Bvh::kWidth];
    field.bounds2(node, child2);
    for (int k = 0; k < node.count; ++k)
      if (child2[k] > most2 * kSlack2) stack[top++] = node.child[k];
  }
  return std::sqrt(most2) * (1.0 + kTwistSlack);
}

double longest_path_brute_force_mm(const Solid& part, const Pose& X_W, const TwistFrame& frame,
                                   const Vec6& xi) {
  double most = 0.0;
  for (std::uint32_t t = 0; t < part.mesh().triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      most = std::max(most, frame.velocity_of(xi, X_W * part.mesh().corner(t, k)).norm());
  return most;
}

}  // namespace mortise::gpd
