#pragma once
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "common/io/log/session_log.h"
#include "common/session/memory/session_state.h"
#include "common/session/tick/step.h"
#include "tests/support/shapes.h"

namespace mortise::test {

/// A layer of balls that one hand moves between two layers that stand: each of them near eight
/// others, so that every pair is asked and remembered anew in every tick in which its ball moves.
class BallBed {
 public:
  /// `side` times `side` balls move; in any tick about `still_share` eighths of them rest.
  explicit BallBed(int side, int still_share = 0) : still_share_(still_share) {
    world_.name = "balls";
    world_.policy = Policy::kStop;
    User hand;
    hand.id = kHand;
    hand.name = "hand";
    hand.present = true;
    world_.users.push_back(hand);
    const SolidPtr ball = shapes::solid(shapes::sphere(kBall_mm, Vec3::Zero(), 8));
    meshes_ = {{ball->hash(), &ball->mesh()}};
    const double half_mm = 0.5 * kPitch_mm, reach_mm = 2.0 * kBall_mm + kGap_mm;
    const double rise_mm = std::sqrt(reach_mm * reach_mm - 2.0 * half_mm * half_mm);
    for (const double z : {-rise_mm, rise_mm})
      for (int i = 0; i <= side; ++i)
        for (int j = 0; j <= side; ++j)
          add(ball, Vec3(kPitch_mm * i - half_mm, kPitch_mm * j - half_mm, z), false);
    for (int i = 0; i < side; ++i)
      for (int j = 0; j < side; ++j) add(ball, Vec3(kPitch_mm * i, kPitch_mm * j, 0.0), true);
  }

  /// Along a small circle in large steps, each ball with its own lag: no distance is of use in the
  /// next tick, and nothing meets.
  const StepReport& tick() {
    ++ticks_;
    increments_.clear();
    for (const Part& part : world_.parts) {
      if (!part.moving || rests(part)) continue;
      const double phase = static_cast<double>(ticks_) + 0.1 * part.id.value;
      const Vec3 way = kCircle_mm * Vec3(std::cos(phase), std::sin(phase), 0.0);
      increments_.push_back(
          {kHand, part.id, ++seq_, part.X_WP_scenario.p + way - part.X_WP.p, Vec3::Zero()});
    }
    return report_ = step(world_, increments_, scratch_);
  }

  /// With the same hand; where the parts stand is a matter of the world.
  void go_on_from(const BallBed& other) {
    ticks_ = other.ticks_;
    seq_ = other.seq_;
  }

  World& world() { return world_; }
  const std::vector<Increment>& increments() const { return increments_; }
  const StepReport& report() const { return report_; }
  std::size_t pairs() const { return world_.state->memos.size(); }
  LogHeader header() const {
    LogHeader header;
    header.session = header.scenario_name = world_.name;
    header.meshes = meshes_;
    header.mesh_of_part.assign(world_.parts.size(), meshes_.front().first);
    return header;
  }

 private:
  static constexpr double kBall_mm = 5.0, kPitch_mm = 10.6, kGap_mm = 0.15, kCircle_mm = 0.1;
  static constexpr UserId kHand{1};

  bool rests(const Part& part) const {
    return (ticks_ / 8 + part.id.value) % 8 < static_cast<std::uint64_t>(still_share_);
  }
  void add(const SolidPtr& solid, const Vec3& at, bool moving) {
    Part part;
    part.id = PartId{static_cast<std::uint32_t>(world_.parts.size() + 1)};
    part.name = "ball_" + std::to_string(part.id.value);
    part.solid = solid;
    part.moving = moving;
    part.X_WP_scenario = part.X_WP = Pose::translation(at);
    if (moving) part.holder = kHand;
    world_.parts.push_back(std::move(part));
  }

  int still_share_;
  World world_;
  Scratch scratch_;
  std::vector<std::pair<std::string, const TriangleMesh*>> meshes_;
  std::vector<Increment> increments_;
  StepReport report_;
  std::uint64_t ticks_ = 0, seq_ = 0;
};

}  // namespace mortise::test
