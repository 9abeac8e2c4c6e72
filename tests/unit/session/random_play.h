#pragma once
#include <random>
#include <string>
#include <vector>

#include "common/math/rotation.h"
#include "common/session/tick/tick_work.h"
#include "tests/unit/session/report_digest.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {

/// A seeded session of boxes that are pushed about, into one another and into walls.
struct RandomPlay {
  SessionBuilder session;
  std::vector<PartId> movers;
  std::vector<UserId> users;
  std::mt19937_64 rng;

  RandomPlay(Policy policy, std::uint64_t seed, int mover_count, bool bands)
      : session(policy), rng(seed) {
    session.add("floor", box_mesh(Vec3(-40, -40, -2), Vec3(40, 40, 0)), at(0, 0, 0), false);
    session.add("wall", box_mesh(Vec3(0, -40, 0), Vec3(1e-3, 40, 20)), at(0, 0, 0), false);
    session.add("post", box_mesh(Vec3(-1, -1, 0), Vec3(1, 1, 20)), at(12, 6, 0), false);
    // Two cheeks in one part: its box holds everything, its faces are far away.
    TriangleMesh frame = box_mesh(Vec3(-38, -40, 0), Vec3(-37, 40, 20));
    const TriangleMesh other = box_mesh(Vec3(37, -40, 0), Vec3(38, 40, 20));
    for (const auto& t : other.triangles) frame.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
    frame.points_mm.insert(frame.points_mm.end(), other.points_mm.begin(), other.points_mm.end());
    session.add("frame", frame, at(0, 0, 0), false);
    for (int i = 0; i < 3; ++i)
      users.push_back(session.join(std::string("user").append(std::to_string(i))));
    for (int i = 0; i < mover_count; ++i) {
      const Vec3 half(size(), size(), size());
      const Pose X_WP{rotation_exp(0.5 * any()),
                      Vec3(6.0 * (i % 4) - 9.0, 7.0 * (i / 4) - 7.0, 6.0)};
      movers.push_back(session.add(std::string("box").append(std::to_string(i)),
                                   box_mesh(-half, half), X_WP, true));
      if (bands) session.set_tolerance(movers.back(), 0.02);
      session.grab(user_of(movers.back()), movers.back());
    }
    if (bands) session.set_tolerance(PartId{1}, 0.01);
  }

  double u() { return std::uniform_real_distribution<double>(-1.0, 1.0)(rng); }
  Vec3 any() {
    const double x = u(), y = u(), z = u();
    return {x, y, z};
  }
  double size() { return 1.0 + 0.6 * std::abs(u()); }
  UserId user_of(PartId part) const { return users[part.value % users.size()]; }

  /// Some movers, some way; sometimes everything at once, sometimes nothing.
  std::vector<Increment> pushes() {
    std::vector<Increment> increments;
    const int mood = static_cast<int>(rng() % 8);
    for (const PartId part : movers) {
      const Vec3 by = 1.5 * any() - Vec3(0, 0, 0.3);
      const Vec3 turn = 0.15 * any();
      if (mood == 0 || (mood < 6 && rng() % 3 != 0)) continue;
      increments.push_back(session.push(user_of(part), part, by, rng() % 2 ? turn : Vec3::Zero()));
    }
    return increments;
  }

  StepReport tick(Scratch& scratch) { return play_tick(session.world, pushes(), scratch); }
};

}  // namespace mortise
