#include "common/session/world/moving_group.h"

#include <algorithm>

#include "common/math/rotation.h"

namespace mortise {
namespace {

Vec3 reference_of(const Part& part) { return part.X_WP * part.solid->sphere().center_mm; }

}  // namespace

MovingGroup moving_group_of(const World& world, std::uint32_t index) {
  MovingGroup group;
  const GroupId id = world.parts[index].group;
  if (!id) {
    const Part& part = world.parts[index];
    return {{index}, reference_of(part), part.solid->sphere().radius_mm};
  }
  for (std::uint32_t i = 0; i < world.parts.size(); ++i)
    if (world.parts[i].group == id) group.parts.push_back(i);
  for (const std::uint32_t i : group.parts) group.reference_W += reference_of(world.parts[i]);
  group.reference_W /= static_cast<double>(group.parts.size());
  for (const std::uint32_t i : group.parts) {
    const Part& part = world.parts[i];
    group.radius_mm = std::max(group.radius_mm, (reference_of(part) - group.reference_W).norm() +
                                                    part.solid->sphere().radius_mm);
  }
  return group;
}

Motion rigid_motion(const Pose& X_W0, const Vec3& center_W, const Displacement& by) {
  const bool turns = !by.turn.vec().isZero(0.0);
  Pose X_W1{X_W0.q, X_W0.p + by.shift_mm};
  if (turns) {
    X_W1.q = (by.turn * X_W0.q).normalized();
    X_W1.p = center_W + by.shift_mm + by.turn * (X_W0.p - center_W);
  }
  Motion motion = linear_motion(X_W0, X_W1, X_W0.inverse() * center_W);
  if (!motion.moves()) return motion;
  motion.v_W = by.shift_mm;
  motion.w_W = turns ? rotation_log(by.turn) : Vec3::Zero();
  motion.axis_W = center_W;
  return motion;
}

Displacement about(const Displacement& by, const Vec3& from_W, const Vec3& to_W) {
  const Vec3 arm = to_W - from_W;
  return {by.turn, by.shift_mm + (by.turn * arm - arm)};
}

Vec3 straight_point(const MovingGroup& group, const std::vector<Relation>& relations) {
  for (const Relation& relation : relations) {
    if (relation.a.kind == ElementKind::kPlane || relation.b.kind == ElementKind::kPlane ||
        relation.distance_mm != 0.0)
      continue;
    if (relation.a.kind == ElementKind::kPoint) return relation.a.point;
    const Vec3 along = relation.a.direction;
    return relation.a.point + (group.reference_W - relation.a.point).dot(along) * along;
  }
  return group.reference_W;
}

std::vector<Relation> relations_of(const World& world, const MovingGroup& group) {
  std::vector<Relation> relations;
  const auto within = [&](PartId part) {
    return std::binary_search(group.parts.begin(), group.parts.end(), part.value - 1);
  };
  for (const Guide& guide : world.guides) {
    const PartId held = guide.constraint.held.part, other = guide.constraint.other.part;
    if (!within(held) || within(other)) continue;
    Relation relation = guide.relation;
    relation.a = moved(relation.a, world.find(held)->X_WP);
    relation.b = moved(relation.b, world.find(other)->X_WP);
    relations.push_back(relation);
  }
  return relations;
}

}  // namespace mortise
