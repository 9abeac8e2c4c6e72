// What holds a part is one clash, wherever it is worst; what holds it elsewhere as well is another.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/base/constants.h"
#include "common/io/scenario/open_scene.h"
#include "common/session/tick/step.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

const char* const kPress = R"(
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
  auto reading = read_scenario_text(kPress, "press.yaml");
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

std::uint64_t begins_of(const StepReport& report) {
  return static_cast<std::uint64_t>(std::count_if(
      report.events.begin(), report.events.end(),
      [](const ClashEvent& event) { return event.kind == ClashEvent::Kind::kBegin; }));
}

// A wall thinner than the push is met with its front and its back, each worst somewhere else in
// every tick.
TEST(ClashIdentity, ACubeHeldByAThinWallHasOneClash) {
  for (const Policy policy : {Policy::kStop, Policy::kSlide}) {
    SessionBuilder session(policy);
    Scratch scratch;
    const UserId ann = session.join("ann");
    session.add("wall", box_mesh({-0.0005, -15, -15}, {0.0005, 15, 15}), at(5.3, 0, 0), false);
    const PartId cube = session.add("cube", cube_mesh(1.0), Pose{}, true);
    session.grab(ann, cube);
    std::uint64_t begins = 0;
    const auto push = [&](int ticks, const Vec3& by) {
      for (int i = 0; i < ticks; ++i)
        begins += begins_of(play_tick(session.world, {session.push(ann, cube, by)}, scratch));
    };
    push(12, Vec3(8, 4, 1) / 12.0);
    push(12, Vec3(2, -9, 3) / 12.0);
    EXPECT_EQ(begins, 1U);
  }
}

// A bar leans on one post of a frame and is turned against the other one: two places.
TEST(ClashIdentity, WhatHoldsFarApartIsTwo) {
  SessionBuilder session(Policy::kStop);
  Scratch scratch;
  const UserId ann = session.join("ann");
  TriangleMesh frame = box_mesh({-20, 0, -2}, {-18, 5, 2});
  const TriangleMesh other = box_mesh({18, 0, -2}, {20, 5, 2});
  for (const auto& triangle : other.triangles)
    frame.triangles.push_back({triangle[0] + 8, triangle[1] + 8, triangle[2] + 8});
  frame.points_mm.insert(frame.points_mm.end(), other.points_mm.begin(), other.points_mm.end());
  session.add("frame", frame, Pose{}, false);
  const PartId bar = session.add("bar", box_mesh({-22, -2, -1}, {22, 0, 1}), at(0, -1, 0), true);
  session.grab(ann, bar);
  const auto push = [&](const Vec3& by, double turn_rad) {
    return play_tick(session.world, {session.push(ann, bar, by, Vec3(0, 0, turn_rad))}, scratch);
  };
  push(Vec3::Zero(), -0.03);
  std::uint64_t begins = 0;
  for (int i = 0; i < 6; ++i) begins += begins_of(push(Vec3(0, 0.2, 0), 0.0));
  EXPECT_EQ(begins, 1U);
  // About the post that held it, off it by a little; the other one then is met at two corners.
  push(Vec3(0, -0.01, 0), 0.0);
  push(Vec3(0, 0.58, 0), 0.029);
  for (int i = 0; i < 6; ++i) begins += begins_of(push(Vec3(0, 0.205, 0), 0.01));
  EXPECT_EQ(begins, 2U);
}

}  // namespace
}  // namespace mortise
