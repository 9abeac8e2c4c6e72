#pragma once
#include <fcl/fcl.h>

#include <memory>

#include "common/ccd/distance.h"
#include "common/geometry/mesh.h"
#include "common/math/pose.h"

namespace mortise::testing {

using FclModel = std::shared_ptr<fcl::BVHModel<fcl::OBBRSSd>>;

inline FclModel fcl_model(const TriangleMesh& mesh) {
  std::vector<fcl::Vector3d> points(mesh.points_mm.begin(), mesh.points_mm.end());
  std::vector<fcl::Triangle> triangles;
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
  model->beginModel();
  model->addSubModel(points, triangles);
  model->endModel();
  return model;
}

inline fcl::Transform3d fcl_pose(const Pose& X) {
  fcl::Transform3d T = fcl::Transform3d::Identity();
  T.linear() = X.rotation();
  T.translation() = X.p;
  return T;
}

inline bool fcl_collide(const FclModel& a, const Pose& X_WA, const FclModel& b, const Pose& X_WB) {
  fcl::CollisionRequestd request;
  fcl::CollisionResultd result;
  fcl::collide(a.get(), fcl_pose(X_WA), b.get(), fcl_pose(X_WB), request, result);
  return result.isCollision();
}

/// 0 or below when the surfaces meet.
inline double fcl_distance(const FclModel& a, const Pose& X_WA, const FclModel& b,
                           const Pose& X_WB) {
  fcl::DistanceRequestd request;
  fcl::DistanceResultd result;
  return fcl::distance(a.get(), fcl_pose(X_WA), b.get(), fcl_pose(X_WB), request, result);
}

}  // namespace mortise::testing
