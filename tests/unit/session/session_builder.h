#pragma once
#include <memory>
#include <string>
#include <vector>

#include "common/session/tick/step.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"
#include "common/session/world/world.h"

namespace mortise {

/// A box from lo to hi, 12 triangles, outward.
inline TriangleMesh box_mesh(const Vec3& lo, const Vec3& hi) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.points_mm.emplace_back(i & 1 ? hi.x() : lo.x(), i & 2 ? hi.y() : lo.y(),
                                i & 4 ? hi.z() : lo.z());
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline TriangleMesh cube_mesh(double edge_mm) {
  return box_mesh(Vec3::Constant(-0.5 * edge_mm), Vec3::Constant(0.5 * edge_mm));
}

/// A session made in code.
struct SessionBuilder {
  World world;
  std::vector<std::uint64_t> next_seq;

  explicit SessionBuilder(Policy policy = Policy::kReport) {
    world.name = "test";
    world.policy = policy;
    world.max_jump_mm = 1e4;
  }

  PartId add(const std::string& name, const TriangleMesh& mesh, const Pose& X_WP, bool moving) {
    Part part;
    part.id = PartId{static_cast<std::uint32_t>(world.parts.size() + 1)};
    part.name = name;
    part.solid = std::make_shared<const Solid>(mesh);
    part.band = nominal_band();
    part.moving = moving;
    part.X_WP_scenario = part.X_WP = X_WP;
    world.parts.push_back(std::move(part));
    return world.parts.back().id;
  }

  /// Every face of the part may lie up to t_mm outside or inside of its mesh.
  void set_tolerance(PartId part, double t_mm) {
    SurfaceBand& band = world.find(part)->band;
    band = nominal_band();
    band.faces[0].tolerance_mm = {-t_mm, t_mm};
    band.faces[0].tolerance_source = "profile";
    band.largest_offset_mm = t_mm;
    band.trivial = false;
    world.evaluates = true;
  }

  UserId join(const std::string& name, Role role = Role::kDesigner) {
    Decision decision;
    decision.kind = Decision::Kind::kJoin;
    decision.user_name = name;
    decision.role = role;
    apply_decision(world, decision);
    next_seq.push_back(1);
    return world.users.back().id;
  }

  Reply command(UserId user, PartId part, CommandKind kind) {
    Decision decision;
    return apply_command(world, Command{user, part, 1, kind}, decision);
  }
  Reply command(UserId user, PartId part, CommandKind kind, Details details) {
    Decision decision;
    return apply_command(world, Command{user, part, 1, kind, std::move(details)}, decision);
  }
  Reply grab(UserId user, PartId part) { return command(user, part, CommandKind::kGrab); }

  Increment push(UserId user, PartId part, const Vec3& translation_mm,
                 const Vec3& rotation_rad = Vec3::Zero()) {
    return {user, part, next_seq[user.value - 1]++, translation_mm, rotation_rad};
  }

  const Pose& pose(PartId part) const { return world.find(part)->X_WP; }
};

inline StepReport play_tick(World& world, const std::vector<Increment>& increments,
                            Scratch& scratch) {
  return step(world, std::span<const Increment>(increments), scratch);
}

inline Pose at(double x, double y, double z) { return Pose::translation(Vec3(x, y, z)); }

}  // namespace mortise
