// One collision of a ring with its seat is one clash, on whichever side it is worst.
#include <gtest/gtest.h>

#include <cmath>

#include "common/base/constants.h"
#include "common/io/open_scene.h"
#include "common/session/step.h"

namespace mortise {
namespace {

const char* const kScenario = R"(
name: press
units: mm
policy: stop
max_jump: 20
parts:
  - {name: plate, generator: {kind: plate_with_bore, bore: 35, facets: 48}}
  - name: ring
    generator: {kind: bearing, bore: 15, outer: 35, width: 11, facets: 32, phase_deg: 4}
    moving: true
    pose: {position: [0, 0, 15.5]}
fits:
  - {between: [plate.bore, ring.outer], code: Ø35 H7/p6}
)";

TEST(ClashIdentity, AroundARingItIsOneClash) {
  auto reading = read_scenario_text(kScenario, "press.yaml");
  ASSERT_TRUE(reading && reading->usable());
  auto scene = load_scene(reading->scenario, default_meshes());
  ASSERT_TRUE(scene && scene->usable());
  World& world = scene->world;
  Decision decision;
  decision.kind = Decision::Kind::kJoin;
  decision.user_name = "ann";
  decision.role = Role::kDesigner;
  apply_decision(world, decision);
  const UserId ann = world.users.back().id;
  const PartId ring = world.find_part("ring")->id;
  apply_command(world, Command{ann, ring, 1, CommandKind::kGrab}, decision);
  Scratch scratch;
  // Down on its seat with both hands: now one side leads, now the other.
  std::uint64_t begins = 0, events = 0;
  Vec3 at = Vec3::Zero();
  for (std::uint64_t i = 1; i <= 60; ++i) {
    const double angle = 2.0 * static_cast<double>(i);
    const Vec3 to(0.02 * std::cos(angle), 0.02 * std::sin(angle), 0.0);
    const Vec3 by = to - at + Vec3(0, 0, i % 3 == 0 ? -1.5 : -0.2);
    at = to;
    const StepReport report =
        step(world, std::vector<Increment>{{ann, ring, i, by, Vec3::Zero()}}, scratch);
    for (const ClashEvent& event : report.events) {
      ++events;
      begins += event.kind == ClashEvent::Kind::kBegin;
    }
  }
  EXPECT_EQ(begins, 1U);
  EXPECT_LE(events, 8U);
  EXPECT_GT(world.find(ring)->X_WP.p.z(), 10.0);
}

}  // namespace
}  // namespace mortise
