#include "common/broadphase/swept_box.h"

#include <gtest/gtest.h>

#include <random>

#include "common/math/rotation.h"

namespace mortise {
namespace {

TEST(SweptBox, TranslationOfABoxIsExact) {
  BodyBounds body;
  body.box_P.add(Vec3(-1, -2, -3));
  body.box_P.add(Vec3(1, 2, 3));
  body.sphere_P = {Vec3::Zero(), Vec3(1, 2, 3).norm()};
  const Motion motion = linear_motion(Pose::translation(Vec3(0, 0, 0)),
                                      Pose::translation(Vec3(5, -7, 0)), Vec3::Zero());
  const Box box = swept_box(body, motion);
  EXPECT_TRUE(box.lo.isApprox(Vec3(-1, -9, -3), 1e-15));
  EXPECT_TRUE(box.hi.isApprox(Vec3(6, 2, 3), 1e-15));
}

TEST(SweptBox, HoldsEveryPointAtEveryTime) {
  std::mt19937_64 rng(11);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto v = [&] { return Vec3(u(rng), u(rng), u(rng)); };
  for (int i = 0; i < 500; ++i) {
    std::vector<Vec3> points;
    BodyBounds body;
    for (int k = 0; k < 12; ++k) {
      points.push_back(5.0 * v());
      body.box_P.add(points.back());
    }
    body.sphere_P.center_mm = body.box_P.center();
    for (const Vec3& p : points)
      body.sphere_P.radius_mm =
          std::max(body.sphere_P.radius_mm, (p - body.sphere_P.center_mm).norm());
    const Vec3 w = v().normalized() * (i % 5 == 0 ? 3.14159 : 3.1 * std::abs(u(rng)));
    const Pose X_W0{rotation_exp(3.0 * v()), 50.0 * v()};
    const Vec3 reference = i % 3 == 0 ? Vec3(v()) : body.sphere_P.center_mm;
    const Quat q1 = rotation_exp(w) * X_W0.q;
    const Pose X_W1{q1, X_W0 * reference + 8.0 * v() - q1 * reference};
    for (const Motion& motion :
         {linear_motion(X_W0, X_W1, reference), screw_motion(X_W0, X_W1, reference)}) {
      const Box box = swept_box(body, motion).grown(1e-11);
      for (int t = 0; t <= 40; ++t) {
        const Pose X = motion.pose_at(t / 40.0);
        for (const Vec3& p : points) {
          const Vec3 x = X * p;
          ASSERT_TRUE((x.array() >= box.lo.array()).all() && (x.array() <= box.hi.array()).all())
              << i << " t " << t;
        }
      }
    }
  }
}

}  // namespace
}  // namespace mortise
