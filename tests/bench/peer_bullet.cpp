// Bullet's continuous convex cast (single precision as Debian builds it) on the convex hulls of the
// points, without margin.
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/NarrowPhaseCollision/btContinuousConvexCollision.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include "common/base/check.h"
#include "tests/bench/methods.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

btVector3 bullet(const Vec3& p) {
  return {static_cast<btScalar>(p.x()), static_cast<btScalar>(p.y()), static_cast<btScalar>(p.z())};
}

btTransform bullet(const Pose& X) {
  return btTransform(btQuaternion(static_cast<btScalar>(X.q.x()), static_cast<btScalar>(X.q.y()),
                                  static_cast<btScalar>(X.q.z()), static_cast<btScalar>(X.q.w())),
                     bullet(X.p));
}

std::shared_ptr<btConvexHullShape> hull_of(const Solid& solid) {
  auto hull = std::make_shared<btConvexHullShape>();
  for (const Vec3& p : solid.mesh().points_mm) hull->addPoint(bullet(p), false);
  hull->recalcLocalAabb();
  hull->setMargin(0);
  return hull;
}

}  // namespace

Method bullet_method(const MotionSet& set) {
  MORTISE_CHECK(set.convex, "Bullet casts convex parts only");
  const auto a = hull_of(*set.moving), b = hull_of(*set.fixed);
  return {kBullet, false, false, 0.0, [a, b](const Motion& motion) {
            const btTransform from = bullet(motion.X_W0), to = bullet(motion.X_W1);
            const btTransform still = btTransform::getIdentity();
            Answer answer;
            bool hit = false;
            answer.time_s = least_time_s([&] {
              btVoronoiSimplexSolver simplex;
              btGjkEpaPenetrationDepthSolver depth;
              btContinuousConvexCollision cast(a.get(), b.get(), &simplex, &depth);
              btConvexCast::CastResult result;
              hit = cast.calcTimeOfImpact(from, to, still, still, result);
              answer.t = hit ? static_cast<double>(result.m_fraction) : 1.0;
            });
            answer.outcome = hit ? Outcome::kContact : Outcome::kFree;
            return answer;
          }};
}

}  // namespace mortise::bench
