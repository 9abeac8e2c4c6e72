// A part that interferes is let out of the other again, whatever the searches have time for.
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "common/io/scenario/open_scene.h"
#include "common/session/tick/judgement.h"
#include "common/session/tick/step.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"

namespace mortise {
namespace {

const std::string kScenario = R"(
name: withdrawal
units: mm
policy: stop
max_jump: 20
parts:
  - name: plate
    generator: {kind: plate_with_bore, bore: 20, facets: 32}
  - name: peg
    generator: {kind: dowel, diameter: 20, length: 40, chamfer: 1, facets: 32, phase_deg: 5.625}
    features:
      chamfer_lower: {tolerance: {lower: -0.1, upper: -0.04}}
      chamfer_upper: {tolerance: {lower: -0.1, upper: -0.04}}
    moving: true
    pose: {position: [0, 0, 25]}
  - {name: stray, generator: {kind: dowel, diameter: 20, length: 40, chamfer: 1, facets: 32}, moving: true,
     pose: {position: [3, 2, 60]}}
fits:
  - {between: [plate.bore, peg.journal], code: Ø20 H7/k6}
)";

/// A scene in which ada has a part in hand.
struct InAdasHand : testing::Test {
  LoadedScene scene;
  Scratch scratch;
  UserId ada;
  PartId held;
  std::uint64_t seq = 0;

  InAdasHand(const std::string& scenario, const char* part) {
    auto reading = read_scenario_text(scenario, "scenario.yaml");
    auto loaded = load_scene(reading->scenario, default_meshes());
    EXPECT_TRUE(loaded && loaded->usable());
    scene = std::move(*loaded);
    Decision decision;
    decision.kind = Decision::Kind::kJoin;
    decision.user_name = "ada";
    decision.role = Role::kDesigner;
    apply_decision(scene.world, decision);
    ada = scene.world.users.back().id;
    held = scene.world.find_part(part)->id;
    apply_command(scene.world, Command{ada, held, 1, CommandKind::kGrab}, decision);
    step(scene.world, {}, scratch);
  }
};

struct Withdrawal : InAdasHand {
  Withdrawal() : InAdasHand(kScenario, "stray") {}
  // Pieces of 1 mm that arrive in one tick, then a tick of rest. Its height after that.
  double push(int pieces, double by_mm) {
    std::vector<Increment> increments;
    for (int i = 0; i < pieces; ++i)
      increments.push_back({ada, held, ++seq, Vec3(0, 0, by_mm), Vec3::Zero()});
    step(scene.world, increments, scratch);
    step(scene.world, {}, scratch);
    return scene.world.find(held)->X_WP.p.z();
  }
};

// 5 mm deep at first; after five pieces both just touch.
TEST_F(Withdrawal, IsNotHeldWhereThePartsJustTouch) {
  for (int i = 1; i <= 5; ++i) EXPECT_NEAR(push(1, 1.0), 60.0 + i, 1e-9);
  const double left = push(1, 1.0);
  EXPECT_GT(left, 65.0 + 0.04);
  EXPECT_NEAR(push(1, 1.0), left + 1.0, 1e-9);
  EXPECT_NEAR(push(3, 1.0), left + 4.0, 1e-9);
  EXPECT_TRUE(snapshot_of(scene.world).open_clashes.empty());
}

TEST_F(Withdrawal, InPiecesOfAnyNumber) {
  for (const int pieces : {2, 3, 4, 2, 3}) push(pieces, 1.0);
  // 5 mm lie behind it when it just touches; of the push from there the rest is lost.
  EXPECT_GT(scene.world.find(held)->X_WP.p.z(), 70.0 + 0.04);
}

// Where they just touch the way out is open, the way in is not.
TEST_F(Withdrawal, FromTheBrinkNothingIsPressedIn) {
  for (int i = 1; i <= 5; ++i) push(1, 1.0);
  for (const double by_mm : {-1.0, -0.02, -0.0005})
    for (int i = 0; i < 8; ++i) EXPECT_GE(push(1, by_mm), 65.0 - 1e-3) << by_mm;
}

const std::string kAskew = R"(
name: askew
units: mm
policy: stop
max_jump: 20
parts:
  - name: plate
    generator: {kind: plate_with_bore, bore: 20, facets: 48}
  - name: peg
    generator: {kind: dowel, diameter: 20, length: 40, chamfer: 1, facets: 48, phase_deg: 3}
    moving: true
    pose: {position: [0.02, 0, 5], rotation_deg: [0.15, 0.1, 0]}
fits:
  - {between: [plate.bore, peg.journal], code: Ø20 H7/p6}
)";

// Pressed in askew, certain to interfere: every push that draws it out goes all its way, and none
// of any other direction makes it deeper.
struct Askew : InAdasHand {
  Askew() : InAdasHand(kAskew, "peg") {}
  const Part& peg() { return *scene.world.find_part("peg"); }
  StepReport push(const Vec3& by_mm, const Vec3& turn_rad = Vec3::Zero()) {
    const std::vector<Increment> increments = {{ada, peg().id, ++seq, by_mm, turn_rad}};
    return step(scene.world, increments, scratch);
  }
  /// Lower bound of what is certain as it stands, whatever the work.
  double depth_mm() {
    JudgementQuery query;
    query.a = &scene.world.parts[0];
    query.b = &scene.world.parts[1];
    query.rule = scene.world.rule(query.a->id, query.b->id);
    query.motion_a = still_motion(query.a->X_WP);
    query.motion_b = still_motion(query.b->X_WP);
    query.refinement = Refinement::kFull;
    query.want_gpd = false;
    CcdScratch ccd;
    double depth = 0.0;
    for (const OverlapRegion& region : judge_pair(query, ccd).overlap.regions)
      depth = std::max(depth, region.certain_mm.lo);
    return depth;
  }
};

TEST_F(Askew, NoPushMakesItDeeper) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  double least_mm = depth_mm();
  ASSERT_GT(least_mm, 0.005);
  for (int i = 0; i < 25; ++i) {
    const auto some = [&](double by) -> Vec3 {
      return by * Vec3(normal(random), normal(random), normal(random));
    };
    push(some(0.05), some(0.002));
    const double depth = depth_mm();
    EXPECT_LE(depth, least_mm + 2.0 * kDeepeningSlack_mm) << i;
    least_mm = std::min(least_mm, depth);
  }
}

TEST_F(Askew, IsDrawnOutAlongItsAxis) {
  ASSERT_GT(depth_mm(), 0.005);
  const Vec3 axis = peg().X_WP.q * Vec3::UnitZ();
  for (int i = 0; i < 45; ++i) {
    const Vec3 before = peg().X_WP.p;
    const StepReport report = push(axis);
    EXPECT_GT((peg().X_WP.p - before).dot(axis), 1.0 - 1e-9) << i;
    EXPECT_EQ(report.counters.not_examined, 0u) << i;
  }
  EXPECT_EQ(depth_mm(), 0.0);
}

}  // namespace
}  // namespace mortise
