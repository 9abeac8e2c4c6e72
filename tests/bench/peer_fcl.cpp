// FCL 0.7 as a peer. Its continuous collision of meshes, as the public function dispatches it,
// applies the pose twice and misses most contacts; the oriented traversal that it never reaches
// works. "Repaired" calls that one, with a motion whose constructor sets all members. What
// remains of FCL's faults is FCL's own: OBBRSS bounds of pruned pairs, a fixed tolerance of 1e-5 in
// time.
#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/detail/conservative_advancement_func_matrix.h>

#include "common/base/check.h"
#include "common/base/constants.h"
#include "tests/bench/methods.h"
#include "tests/bench/statistics.h"
#include "tests/oracle/fcl_model.h"

namespace mortise::bench {
namespace {

using testing::fcl_pose;

template <class BV>
using Model = std::shared_ptr<fcl::BVHModel<BV>>;

template <class BV>
Model<BV> model_of(const Solid& solid) {
  std::vector<fcl::Vector3d> points(solid.mesh().points_mm.begin(), solid.mesh().points_mm.end());
  std::vector<fcl::Triangle> triangles;
  for (const auto& t : solid.mesh().triangles) triangles.emplace_back(t[0], t[1], t[2]);
  auto model = std::make_shared<fcl::BVHModel<BV>>();
  model->beginModel();
  model->addSubModel(points, triangles);
  model->endModel();
  return model;
}

using Oriented = Model<fcl::OBBRSSd>;
using Rounded = Model<fcl::RSSd>;

// FCL's linear motion about the part's origin is ours. Its screw agrees with ours where the part
// turns; a pure translation has to be asked as a linear one.
bool is_screw(const Motion& motion) { return motion.kind == PathKind::kScrew; }

std::unique_ptr<fcl::MotionBased> fcl_motion(const Motion& motion) {
  const fcl::Transform3d T0 = fcl_pose(motion.X_W0), T1 = fcl_pose(motion.X_W1);
  if (is_screw(motion)) return std::make_unique<fcl::ScrewMotion<double>>(T0, T1);
  return std::make_unique<fcl::InterpMotion<double>>(T0.linear(), T0.translation(), T1.linear(),
                                                     T1.translation(), fcl::Vector3d::Zero());
}

template <class Find>
Answer timed(Find&& find) {
  Answer answer;
  double t = 1.0;
  bool hit = false;
  answer.time_s = least_time_s([&] { hit = find(t); });
  answer.outcome = hit ? Outcome::kContact : Outcome::kFree;
  answer.t = hit ? t : 1.0;
  return answer;
}

Method shipped(const Oriented& a, const Oriented& b) {
  return {kShipped, false, false, 0.0, [a, b](const Motion& motion) {
            const fcl::Transform3d T0 = fcl_pose(motion.X_W0), T1 = fcl_pose(motion.X_W1);
            const fcl::Transform3d still = fcl::Transform3d::Identity();
            const fcl::ContinuousCollisionRequestd request(
                10, 1e-4, is_screw(motion) ? fcl::CCDM_SCREW : fcl::CCDM_LINEAR, fcl::GST_LIBCCD,
                fcl::CCDC_CONSERVATIVE_ADVANCEMENT);
            return timed([&](double& t) {
              fcl::ContinuousCollisionResultd result;
              fcl::continuousCollide(a.get(), T0, T1, b.get(), still, still, request, result);
              t = result.time_of_contact;
              return result.is_collide;
            });
          }};
}

template <class BV, class Node>
Method repaired(const char* name, const Model<BV>& a, const Model<BV>& b) {
  return {name, false, false, 0.0, [a, b](const Motion& motion) {
            return timed([&](double& t) {
              const auto moving = fcl_motion(motion);
              const fcl::InterpMotion<double> still(
                  fcl::Matrix3d::Identity(), fcl::Vector3d::Zero(), fcl::Matrix3d::Identity(),
                  fcl::Vector3d::Zero(), fcl::Vector3d::Zero());
              const fcl::CollisionRequestd request;
              fcl::CollisionResultd result;
              return fcl::detail::conservativeAdvancementMeshOriented<BV, Node>(
                  *a, moving.get(), *b, &still, request, result, t);
            });
          }};
}

Method on_distance(const Oriented& a, const Oriented& b, const Solid& moving) {
  double radius_mm = 0.0;
  for (const Vec3& p : moving.mesh().points_mm) radius_mm = std::max(radius_mm, p.norm());
  return {kOnDistance, false, false, kAccuracyDefault_mm, [a, b, radius_mm](const Motion& motion) {
            const double speed_mm = motion.travel_upper_bound_mm(radius_mm, 0.0, 1.0);
            return timed([&](double& t) {
              for (t = 0.0; t < 1.0;) {
                const double d_mm = testing::fcl_distance(a, motion.pose_at(t), b, {});
                if (d_mm <= kAccuracyDefault_mm) return true;
                t += d_mm / speed_mm;
              }
              return false;
            });
          }};
}

Method sub_steps(const char* name, int count, const Oriented& a, const Oriented& b) {
  return {name, false, false, 0.0, [a, b, count](const Motion& motion) {
            return timed([&](double& t) {
              for (int i = 0; i <= count; ++i) {
                t = static_cast<double>(i) / count;
                if (testing::fcl_collide(a, motion.pose_at(t), b, {})) return true;
              }
              return false;
            });
          }};
}

}  // namespace

std::vector<Method> fcl_methods(const MotionSet& set) {
  for (const MotionSet::Item& item : set.items)
    MORTISE_CHECK(item.motion.reference_P.isZero(0.0), "peers turn parts about their origin");
  const Oriented a = model_of<fcl::OBBRSSd>(*set.moving), b = model_of<fcl::OBBRSSd>(*set.fixed);
  const Rounded ra = model_of<fcl::RSSd>(*set.moving), rb = model_of<fcl::RSSd>(*set.fixed);
  using fcl::detail::MeshConservativeAdvancementTraversalNodeOBBRSS;
  using fcl::detail::MeshConservativeAdvancementTraversalNodeRSS;
  return {shipped(a, b),
          repaired<fcl::OBBRSSd, MeshConservativeAdvancementTraversalNodeOBBRSS<double>>(
              kRepairedOBBRSS, a, b),
          repaired<fcl::RSSd, MeshConservativeAdvancementTraversalNodeRSS<double>>(kRepairedRSS, ra,
                                                                                   rb),
          on_distance(a, b, *set.moving),
          sub_steps(kSubSteps10, 10, a, b),
          sub_steps(kSubSteps100, 100, a, b),
          sub_steps(kSubSteps1000, 1000, a, b)};
}

}  // namespace mortise::bench
