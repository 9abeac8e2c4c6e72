#pragma once
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <utility>
#include <vector>

#include "common/io/log/session_log.h"
#include "common/io/scenario/open_scene.h"
#include "common/math/rotation.h"
#include "common/session/tick/step.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"

/// Sessions in which several users do everything that a session lets them do, at random: pushes,
/// groups, undo, redo, reset, hand-over, constraints, reviews, and changes of policy, tolerances,
/// fits and exclusions; where `edits`, parts also come, go, come back, begin to move, and take
/// other meshes.
namespace mortise::test {

inline const std::string kRandomScenario = R"(
name: random
units: mm
policy: stop
max_jump: 20
deviation: recognized
parts:
  - name: floor
    generator: {kind: block, x: 120, y: 120, z: 4}
    pose: {position: [0, 0, -2]}
  - name: plate
    generator: {kind: plate_with_bore, bore: 20, facets: 32}
    pose: {position: [60, 0, 30]}
  - name: peg
    generator: {kind: dowel, diameter: 20, length: 40, chamfer: 1, facets: 32, phase_deg: 5.625}
    moving: true
    instances:
      - {name: peg_1, pose: {position: [60, 0, 58]}}
      - {name: peg_2, pose: {position: [20, 20, 30]}}
  - name: block
    generator: {kind: block, x: 9, y: 7, z: 6}
    tolerance: "±0.02"
    moving: true
    instances:
      - {name: block_1, pose: {position: [-20, -20, 8]}}
      - {name: block_2, pose: {position: [-8, -20, 8]}}
      - {name: block_3, pose: {position: [-20, -8, 8]}}
      - {name: block_4, pose: {position: [-8, -8, 16]}}
fits:
  - {between: [plate.bore, peg_*.journal], code: Ø20 H7/g6}
)";

inline Result<LoadedScene> random_scene() {
  auto reading = read_scenario_text(kRandomScenario, "random.yaml");
  if (!reading) return reading.error();
  return load_scene(reading->scenario, default_meshes());
}

class RandomSession {
 public:
  explicit RandomSession(std::uint64_t seed, int users = 3, bool edits = false,
                         bool replaces = true)
      : random_(seed), edits_(edits), replaces_(replaces) {
    auto loaded = random_scene();
    EXPECT_TRUE(loaded && loaded->usable());
    for (const Finding& finding : loaded->findings) EXPECT_FALSE(finding.is_error) << finding.text;
    scene = std::move(*loaded);
    header.session = "random";
    header.scenario_name = "random.yaml";
    header.scenario_yaml = kRandomScenario;
    std::map<std::string, const TriangleMesh*> meshes;
    for (const Part& part : scene.world.parts) {
      meshes.emplace(part.solid->hash(), &part.solid->mesh());
      header.mesh_of_part.push_back(part.solid->hash());
      if (part.moving) movers_.push_back(part.id);
    }
    header.meshes.assign(meshes.begin(), meshes.end());
    for (int i = 0; i < users; ++i) join(UserId{static_cast<std::uint32_t>(i + 1)});
    seq_.assign(static_cast<std::size_t>(users) + 1, 0);
  }

  /// One tick more; what went in and what came out.
  const TickRecord& tick() {
    for (int i = static_cast<int>(below(3)); i > 0; --i) act();
    TickRecord record;
    record.meshes = std::exchange(meshes_, {});
    record.decisions = std::exchange(decisions_, {});
    record.increments = pushes();
    record.report = step(scene.world, record.increments, scratch_);
    record.tick = record.report.tick;
    record.time_ns = static_cast<std::int64_t>(record.tick) * 16'666'667;
    ticks.push_back(std::move(record));
    return ticks.back();
  }

  LoadedScene scene;
  LogHeader header;
  std::vector<TickRecord> ticks;
  std::size_t accepted[kCommandKindCount] = {};  ///< commands by kind

 private:
  std::uint64_t below(std::uint64_t n) { return random_() % n; }
  double u() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); }
  UserId user() { return UserId{static_cast<std::uint32_t>(1 + below(seq_.size() - 1))}; }
  PartId mover() { return movers_[below(movers_.size())]; }

  void join(UserId id) {
    Decision join;
    join.kind = Decision::Kind::kJoin;
    join.user = id;
    join.user_name = "user" + std::to_string(id.value);
    join.role = Role::kDesigner;
    apply_decision(scene.world, join);
    decisions_.push_back(std::move(join));
  }
  void ask(UserId user, CommandKind kind, PartId part, Details details = {}) {
    Decision decision;
    const Reply reply =
        apply_command(scene.world, {user, part, ++commands_, kind, std::move(details)}, decision);
    if (reply.refusal != Refusal::kNone) return;
    ++accepted[static_cast<std::size_t>(kind)];
    decisions_.push_back(std::move(decision));
  }

  // Parts of the session, and once a mesh that it did not have.
  void edit() {
    std::vector<Part>& parts = scene.world.parts;
    const Part& some = parts[below(parts.size())];
    const bool is_floor_or_plate = some.id.value <= 2;
    Details details;
    PartEdit& said = details.edit.emplace();
    switch (below(replaces_ ? 7 : 6)) {
      case 6: {
        said.mesh_hash = below(2) == 0 ? new_mesh() : parts[below(parts.size())].solid->hash();
        return some.id.value == 1 ? void()
                                  : ask(user(), CommandKind::kReplacePart, some.id, details);
      }
      case 0:
        if (is_floor_or_plate || parts.size() > 14) return;
        said = {"extra_" + std::to_string(parts.size()),
                below(2) == 0 ? new_mesh() : some.solid->hash(),
                Pose{random_rotation(), 45.0 * Vec3(u(), u(), 0.4 + 0.5 * u())}, below(3) != 0,
                0.0};
        ask(user(), CommandKind::kAddPart, PartId{}, details);
        if (parts.back().moving && parts.back().id != movers_.back())
          movers_.push_back(parts.back().id);
        return;
      case 1:
        return is_floor_or_plate ? void() : ask(user(), CommandKind::kRemovePart, some.id);
      case 2:
        said.moving = !some.moving;
        return some.id.value == 1 ? void() : ask(user(), CommandKind::kSetMoving, some.id, details);
      case 3:
      case 4:
        return ask(user(), CommandKind::kUndo, some.id);
      default:
        return ask(user(), CommandKind::kRedo, some.id);
    }
  }
  std::string new_mesh() {
    TriangleMesh mesh = scene.world.parts.back().solid->mesh();
    for (Vec3& point : mesh.points_mm) point *= 1.0 + 0.1 * std::fabs(u());
    meshes_.push_back(std::make_shared<const Solid>(std::move(mesh)));
    scene.world.shapes->add(meshes_.back(), 1e-4);
    return meshes_.back()->hash();
  }
  Quat random_rotation() { return Quat(1.0, u(), u(), u()).normalized(); }

  void act() {
    if (edits_ && below(3) == 0) return edit();
    const PartId part = mover();
    const Part& state = *scene.world.find(part);
    const UserId who = state.holder && below(4) != 0 ? state.holder : user();
    Details details;
    switch (below(16)) {
      case 0:
      case 1:
      case 2:
        return ask(who, CommandKind::kGrab, part);
      case 3:
        details.parts = {movers_[2], movers_[3]};
        return ask(user(), CommandKind::kGrab, PartId{}, details);
      case 4:
        return ask(who, CommandKind::kRelease, part);
      case 5:
        return ask(who, CommandKind::kUndo, part);
      case 6:
        return ask(who, CommandKind::kRedo, part);
      case 7:
        return below(4) == 0 ? ask(who, CommandKind::kReset, part) : void();
      case 8:
        ask(user(), CommandKind::kAskHandOver, part);
        if (below(4) == 0) return ask(state.asked_by, CommandKind::kWithdraw, part);
        return below(2) == 0 ? ask(state.holder, CommandKind::kConsent, part) : void();
      case 9: {
        constexpr const char* kPolicies[] = {"stop", "slide", "report", "slide"};
        details.text = kPolicies[below(4)];
        return below(4) == 0 ? ask(who, CommandKind::kSetPolicy, PartId{}, details) : void();
      }
      case 10: {
        constexpr const char* kTolerances[] = {"±0.01", "{profile: 0.1}", "", "±0.05"};
        details.text = kTolerances[below(4)];
        return ask(who, CommandKind::kSetTolerance, part, details);
      }
      case 11: {
        constexpr const char* kFits[] = {"Ø20 H7/g6", "Ø20 H7/p6", "Ø20 H7/k6", ""};
        details.other_part = movers_[below(2)];
        details.feature = "bore";
        details.other_feature = "journal";
        details.text = kFits[below(4)];
        return ask(who, CommandKind::kSetTolerance, PartId{2}, details);
      }
      case 12:
        details.other_part = mover();
        details.text = "meant so";
        return ask(who, below(2) ? CommandKind::kSetExclusion : CommandKind::kDropExclusion, part,
                   details);
      case 13: {
        const Snapshot now = snapshot_of(scene.world);
        if (now.open_clashes.empty()) return;
        details.clash = now.open_clashes[below(now.open_clashes.size())].clash;
        details.status = static_cast<ReviewStatus>(1 + below(4));
        details.text = "seen";
        details.other_user = below(2) == 0 ? UserId{} : user();
        return ask(who, CommandKind::kReview, PartId{}, details);
      }
      case 14:
        details.constraint = {ConstraintKind::kCoaxial,
                              {movers_[below(2)], "journal"},
                              {PartId{2}, "bore"},
                              0.0,
                              below(2) == 0};
        return ask(scene.world.find(details.constraint.held.part)->holder,
                   CommandKind::kAddConstraint, details.constraint.held.part, details);
      default:
        if (scene.world.guides.empty() || below(3) != 0) return leave_or_come(who);
        details.constraint_id = scene.world.guides.front().id;
        return ask(scene.world.guides.front().user, CommandKind::kDropConstraint,
                   scene.world.guides.front().constraint.held.part, details);
    }
  }

  void leave_or_come(UserId id) {
    if (below(4) != 0) return;
    if (!scene.world.find(id)->present) {
      seq_[id.value] = 0;
      return join(id);
    }
    Decision leave;
    leave.kind = below(2) ? Decision::Kind::kLeave : Decision::Kind::kLivelinessLost;
    leave.user = id;
    apply_decision(scene.world, leave);
    decisions_.push_back(std::move(leave));
  }

  // Down and inwards, so that they meet; now and then nobody does anything.
  std::vector<Increment> pushes() {
    std::vector<Increment> increments;
    if (below(8) == 0) return increments;
    for (const PartId id : movers_) {
      const Part& part = *scene.world.find(id);
      if (!part.holder || below(3) == 0) continue;
      const Vec3 home = part.X_WP_scenario.p - Vec3(0, 0, 18);
      const Vec3 by = 0.6 * Vec3(u(), u(), u()) + 0.04 * (home - part.X_WP.p);
      const Vec3 turn = below(2) ? Vec3(0.03 * Vec3(u(), u(), u())) : Vec3(Vec3::Zero());
      increments.push_back({part.holder, id, ++seq_[part.holder.value], by, turn});
    }
    return increments;
  }

  std::mt19937_64 random_;
  bool edits_, replaces_;
  std::vector<PartId> movers_;
  std::vector<std::uint64_t> seq_;  ///< by user
  std::uint64_t commands_ = 0;
  std::vector<Decision> decisions_;
  std::vector<SolidPtr> meshes_;  ///< new in this tick
  Scratch scratch_;
};

}  // namespace mortise::test
