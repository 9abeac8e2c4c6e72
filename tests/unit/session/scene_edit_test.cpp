// Parts come, go, and begin to move while the session runs.
#include <gtest/gtest.h>

#include <thread>

#include "common/depth/body_index.h"
#include "common/depth/depth.h"
#include "common/messages/names.h"
#include "common/session/memory/session_state.h"
#include "common/session/world/part_shapes.h"
#include "common/session/world/scene_edits.h"
#include "tests/unit/session/session_builder.h"

namespace mortise {
namespace {

Details edit_of(PartEdit edit) {
  Details details;
  details.edit = std::move(edit);
  return details;
}

Details moving(bool moves) { return edit_of({"", "", {}, moves, 0.0}); }

class SceneEdit : public ::testing::Test {
 protected:
  void SetUp() override {
    world().shapes = std::make_shared<PartShapes>([](SolidPtr solid, double) {
      return PartShape{std::move(solid), {}, nominal_band()};
    });
    world().shapes->add(std::make_shared<const Solid>(cube_mesh(10.0)), 0.0);
    cube_hash = world().shapes->meshes().begin()->first;
    const auto cube = [this](double edge_mm) {
      const auto solid = std::make_shared<const Solid>(cube_mesh(edge_mm));
      world().shapes->add(solid, 0.0);
      return solid->hash();
    };
    small_hash = cube(2.0), larger_hash = cube(28.0), large_hash = cube(70.0);
    tick();
  }
  World& world() { return session.world; }
  StepReport tick(const std::vector<Increment>& increments = {}) {
    return play_tick(world(), increments, scratch);
  }
  Reply ask(UserId user, CommandKind kind, PartId part, Details details = {}) {
    return session.command(user, part, kind, std::move(details));
  }
  Refusal refusal(UserId user, CommandKind kind, PartId part, Details details = {}) {
    return ask(user, kind, part, std::move(details)).refusal;
  }
  Reply add(const std::string& name, const Pose& X_WP, bool moves = true) {
    return ask(ada, CommandKind::kAddPart, PartId{}, edit_of({name, cube_hash, X_WP, moves, 0.0}));
  }
  std::vector<PartId> told_parts() {
    std::vector<PartId> ids;
    for (const PartInfo& part : snapshot_of(world()).parts) ids.push_back(part.part);
    return ids;
  }

  SessionBuilder session;
  // A wall, and two cubes that stand 1 mm deep in it; one more lies far away.
  PartId wall = session.add("wall", box_mesh(Vec3(-50, -50, -10), Vec3(50, 50, 0)), {}, false);
  PartId red = session.add("red", cube_mesh(10.0), at(-20, 0, 4), true);
  PartId blue = session.add("blue", cube_mesh(10.0), at(20, 0, 4), true);
  PartId far = session.add("far", cube_mesh(10.0), at(0, 0, 500), true);
  UserId ada = session.join("ada"), bob = session.join("bob");
  UserId bot = session.join("bot", Role::kBot);
  Scratch scratch{1};
  std::string cube_hash, small_hash, larger_hash, large_hash;
};

TEST_F(SceneEdit, NeedsTheRight) {
  for (const CommandKind kind : {CommandKind::kAddPart, CommandKind::kReplacePart,
                                 CommandKind::kRemovePart, CommandKind::kSetMoving}) {
    EXPECT_EQ(refusal(bot, kind, red, moving(false)), Refusal::kNoRight) << name_of(kind);
    world().may_hold = {{"ada", {"*"}, {}, std::vector<Right>{Right::kPolicy, Right::kReview}}};
    EXPECT_EQ(refusal(ada, kind, red, moving(false)), Refusal::kNoRight) << name_of(kind);
    world().may_hold = {};
  }
  world().may_hold = {{"ada", {}, {}, std::vector<Right>{Right::kParts}}};
  EXPECT_EQ(refusal(ada, CommandKind::kRemovePart, red), Refusal::kNone);
}

// 1. to move or not

TEST_F(SceneEdit, WhatCeasesToMoveCanNoLongerBeHeld) {
  ASSERT_EQ(session.grab(ada, red).refusal, Refusal::kNone);
  EXPECT_EQ(refusal(bob, CommandKind::kSetMoving, red, moving(false)), Refusal::kHeldByOther);
  EXPECT_EQ(refusal(ada, CommandKind::kSetMoving, red, moving(true)), Refusal::kBadPart);
  ASSERT_EQ(refusal(ada, CommandKind::kSetMoving, red, moving(false)), Refusal::kNone);
  EXPECT_FALSE(world().find(red)->holder);
  EXPECT_EQ(session.grab(ada, red).refusal, Refusal::kPartIsStatic);
  const StepReport report = tick({session.push(ada, red, Vec3(1, 0, 0))});
  ASSERT_EQ(report.refused.size(), 1U);
  EXPECT_EQ(report.refused[0].reason, Refusal::kPartIsStatic);
}

// Two parts that stand for good are judged by nobody.
TEST_F(SceneEdit, TheClashOfTwoThatStandEndsAndBeginsAgain) {
  ASSERT_EQ(snapshot_of(world()).open_clashes.size(), 2U);
  ASSERT_EQ(refusal(ada, CommandKind::kSetMoving, red, moving(false)), Refusal::kNone);
  StepReport report = tick();
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, ClashEvent::Kind::kEnd);
  EXPECT_EQ(report.events[0].cause, Decision::Kind::kSetMoving);
  EXPECT_EQ(report.events[0].user, ada);
  EXPECT_EQ(report.events[0].part_b, red);
  EXPECT_EQ(snapshot_of(world()).open_clashes.size(), 1U);
  EXPECT_EQ(refusal(bob, CommandKind::kUndo, red), Refusal::kMovedBySomeoneElse);
  ASSERT_EQ(refusal(ada, CommandKind::kUndo, red), Refusal::kNone);
  report = tick();
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, ClashEvent::Kind::kBegin);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kReal);
  EXPECT_EQ(report.events[0].cause, Decision::Kind::kUndo);
  ASSERT_EQ(refusal(ada, CommandKind::kRedo, red), Refusal::kNone);
  EXPECT_EQ(tick().events.size(), 1U);
}

TEST_F(SceneEdit, WhatBeginsToMoveIsJudged) {
  const PartId shelf = session.add("shelf", box_mesh(Vec3(-5, -5, -40), Vec3(5, 5, -5)), {}, false);
  world().state.reset();  // one of the larger scene
  EXPECT_EQ(tick().events.size(), 2U) << "wall and shelf meet and nobody asks";
  ASSERT_EQ(refusal(ada, CommandKind::kSetMoving, shelf, moving(true)), Refusal::kNone);
  const StepReport report = tick();
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].part_a, wall);
  EXPECT_EQ(report.events[0].part_b, shelf);
  EXPECT_EQ(session.grab(ada, shelf).refusal, Refusal::kNone);
  EXPECT_EQ(tick({session.push(ada, shelf, Vec3(0, 0, -50))}).moved.size(), 1U);
}

// 2. to go and to come back

TEST_F(SceneEdit, ARemovedPartIsGoneForEverybody) {
  ASSERT_EQ(session.grab(ada, red).refusal, Refusal::kNone);
  EXPECT_EQ(refusal(bob, CommandKind::kRemovePart, red), Refusal::kHeldByOther);
  ASSERT_EQ(refusal(ada, CommandKind::kRemovePart, red), Refusal::kNone);
  const StepReport report = tick({session.push(ada, red, Vec3(1, 0, 0))});
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, ClashEvent::Kind::kEnd);
  EXPECT_EQ(report.events[0].cause, Decision::Kind::kRemovePart);
  ASSERT_EQ(report.refused.size(), 1U);
  EXPECT_EQ(report.refused[0].reason, Refusal::kUnknownPart);
  EXPECT_EQ(told_parts(), (std::vector<PartId>{wall, blue, far}));
  EXPECT_EQ(world().find_part("red"), nullptr);
  for (const CommandKind kind : {CommandKind::kGrab, CommandKind::kReset, CommandKind::kRemovePart,
                                 CommandKind::kSetMoving, CommandKind::kAskHandOver})
    EXPECT_EQ(refusal(ada, kind, red, kind == CommandKind::kSetMoving ? moving(false) : Details{}),
              Refusal::kUnknownPart)
        << name_of(kind);
  Details with_red;
  with_red.other_part = red;
  with_red.text = "so";
  EXPECT_EQ(refusal(ada, CommandKind::kSetExclusion, blue, with_red), Refusal::kUnknownPart);
}

TEST_F(SceneEdit, WhatComesBackIsAsItWas) {
  Details said;
  said.other_part = red;
  said.text = "welded";
  ASSERT_EQ(refusal(ada, CommandKind::kSetExclusion, wall, said), Refusal::kNone);
  tick();
  ASSERT_EQ(refusal(ada, CommandKind::kDropExclusion, wall, said), Refusal::kNone);
  tick();
  const std::uint64_t standing = snapshot_of(world()).standing.size();
  ASSERT_EQ(refusal(ada, CommandKind::kRemovePart, red), Refusal::kNone);
  EXPECT_EQ(snapshot_of(world()).standing.size(), standing - 1);
  tick();
  for (int i = 0; i < 5; ++i) tick();
  ASSERT_EQ(refusal(ada, CommandKind::kUndo, red), Refusal::kNone);
  const StepReport report = tick();
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, ClashEvent::Kind::kBegin);
  EXPECT_EQ(snapshot_of(world()).standing.size(), standing);
  EXPECT_EQ(told_parts().size(), 4U);
  EXPECT_EQ(session.grab(bob, red).refusal, Refusal::kNone);
}

TEST_F(SceneEdit, ANameCanBeTakenAndThenKeepsTheOtherAway) {
  ASSERT_EQ(refusal(ada, CommandKind::kRemovePart, red), Refusal::kNone);
  ASSERT_EQ(add("red", at(0, 30, 200)).refusal, Refusal::kNone);
  const Reply reply = ask(ada, CommandKind::kUndo, red);
  EXPECT_EQ(reply.refusal, Refusal::kBadPart);
  EXPECT_NE(reply.text.find("'red'"), std::string::npos) << reply.text;
}

// 3. to come

TEST_F(SceneEdit, AnAddedPartIsAPartAsAnyOther) {
  Decision decision;
  const Reply reply = apply_command(world(),
                                    {ada, PartId{}, 1, CommandKind::kAddPart,
                                     edit_of({"new", cube_hash, at(0, 0, 4), true, 0.0})},
                                    decision);
  ASSERT_EQ(reply.refusal, Refusal::kNone) << reply.text;
  EXPECT_EQ(decision.part, PartId{5});
  StepReport report = tick();
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, ClashEvent::Kind::kBegin);
  EXPECT_EQ(report.events[0].cause, Decision::Kind::kAddPart);
  EXPECT_EQ(report.events[0].part_b, PartId{5});
  ASSERT_EQ(session.grab(bob, PartId{5}).refusal, Refusal::kNone);
  report = tick({session.push(bob, PartId{5}, Vec3(0, 0, 20))});
  EXPECT_EQ(report.moved.size(), 1U);
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, ClashEvent::Kind::kEnd);
  // What somebody else moved is theirs to take back first.
  EXPECT_EQ(refusal(ada, CommandKind::kUndo, PartId{5}), Refusal::kMovedBySomeoneElse);
  ASSERT_EQ(refusal(bob, CommandKind::kUndo, PartId{5}), Refusal::kNone);
  ASSERT_EQ(refusal(bob, CommandKind::kRelease, PartId{5}), Refusal::kNone);
  tick();
  ASSERT_EQ(refusal(ada, CommandKind::kUndo, PartId{5}), Refusal::kNone);
  EXPECT_EQ(tick().events.at(0).kind, ClashEvent::Kind::kEnd);
  EXPECT_EQ(told_parts().size(), 4U);
  ASSERT_EQ(refusal(ada, CommandKind::kRedo, PartId{5}), Refusal::kNone);
  EXPECT_EQ(tick().events.at(0).kind, ClashEvent::Kind::kBegin);
}

TEST_F(SceneEdit, AStaticPartIsAddedAmongMovingOnes) {
  ASSERT_EQ(add("post", at(0, 0, 500), false).refusal, Refusal::kNone);
  const StepReport report = tick();
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].part_a, far);
  EXPECT_EQ(report.events[0].part_b, PartId{5});
  EXPECT_EQ(report.events[0].cause, Decision::Kind::kAddPart);
}

TEST_F(SceneEdit, WhatIsNoPartIsRefusedInOneLine) {
  const auto refused = [&](PartEdit edit) {
    return ask(ada, CommandKind::kAddPart, PartId{}, edit_of(std::move(edit)));
  };
  EXPECT_EQ(refused({"red", cube_hash, {}, true, 0.0}).refusal, Refusal::kBadPart);
  EXPECT_EQ(refused({"re.d", cube_hash, {}, true, 0.0}).refusal, Refusal::kBadPart);
  EXPECT_EQ(refused({"", cube_hash, {}, true, 0.0}).refusal, Refusal::kBadPart);
  EXPECT_EQ(refused({"new", "feed", {}, true, 0.0}).refusal, Refusal::kUnknownMesh);
  EXPECT_EQ(refused({"new", cube_hash, at(1e300, 0, 0), true, 0.0}).refusal, Refusal::kBadPart);
  EXPECT_EQ(refusal(ada, CommandKind::kAddPart, PartId{}), Refusal::kBadPart);
  EXPECT_EQ(world().parts.size(), 4U);
  for (std::size_t i = world().parts.size(); i < kMostSceneParts; ++i)
    ASSERT_EQ(
        add("p" + std::to_string(i), at(20.0 * static_cast<double>(i), 0, 1e4), false).refusal,
        Refusal::kNone);
  const Reply reply = add("more", {});
  EXPECT_EQ(reply.refusal, Refusal::kTooManyParts);
  EXPECT_EQ(reply.text.find('\n'), std::string::npos);
}

// 4. to be another one

TEST_F(SceneEdit, AReplacedPartIsTheSamePartWithAnotherMesh) {
  const auto replace = [&](PartId part, const std::string& hash) {
    return ask(ada, CommandKind::kReplacePart, part, edit_of({"", hash, {}, false, 0.0}));
  };
  ASSERT_EQ(session.grab(ada, red).refusal, Refusal::kNone);
  tick({session.push(ada, red, Vec3(1, 0, 0))});
  const Pose X_WP = world().find(red)->X_WP;
  const ClashId clash = snapshot_of(world()).open_clashes[0].clash;
  Details said;
  said.clash = clash;
  said.text = "known";
  said.status = ReviewStatus::kActive;
  ASSERT_EQ(refusal(ada, CommandKind::kReview, PartId{}, said), Refusal::kNone);
  EXPECT_EQ(
      session
          .command(bob, red, CommandKind::kReplacePart, edit_of({"", large_hash, {}, false, 0.0}))
          .refusal,
      Refusal::kHeldByOther);
  ASSERT_EQ(replace(red, large_hash).refusal, Refusal::kNone);
  EXPECT_EQ(replace(red, large_hash).refusal, Refusal::kBadPart) << "it has this mesh";
  StepReport report = tick();
  const Part& part = *world().find(red);
  EXPECT_EQ(part.name, "red");
  EXPECT_EQ(part.holder, ada);
  EXPECT_TRUE(identical(part.X_WP, X_WP));
  EXPECT_EQ(part.solid->hash(), large_hash);
  for (const PartInfo& info : snapshot_of(world()).parts)
    if (info.part == red) {
      EXPECT_EQ(info.mesh_hash, large_hash);
    }
  // The clash with the wall goes on and is told anew, with all that was said of it; the one with
  // blue is new.
  const auto event_with = [&](PartId other, ClashEvent::Kind kind) {
    return std::ranges::any_of(report.events, [&](const ClashEvent& event) {
      return event.kind == kind && (event.part_a == other || event.part_b == other) &&
             event.cause == Decision::Kind::kReplacePart;
    });
  };
  EXPECT_TRUE(event_with(wall, ClashEvent::Kind::kChange));
  EXPECT_TRUE(event_with(blue, ClashEvent::Kind::kBegin));
  EXPECT_EQ(report.events.size(), 3U) << "and the review is told";
  EXPECT_EQ(world().remarks.size(), 1U);
  // Another one far from everything it touched: its clashes are gone.
  ASSERT_EQ(replace(red, small_hash).refusal, Refusal::kNone);
  report = tick();
  EXPECT_TRUE(event_with(wall, ClashEvent::Kind::kEnd));
  EXPECT_TRUE(event_with(blue, ClashEvent::Kind::kEnd));
  // Undo and redo take it as any other edit.
  ASSERT_EQ(refusal(ada, CommandKind::kUndo, red), Refusal::kNone);
  EXPECT_EQ(world().find(red)->solid->hash(), large_hash);
  EXPECT_EQ(tick().events.size(), 2U);
  ASSERT_EQ(refusal(ada, CommandKind::kUndo, red), Refusal::kNone);
  EXPECT_EQ(world().find(red)->solid->hash(), cube_hash);
  tick();
  ASSERT_EQ(refusal(ada, CommandKind::kRedo, red), Refusal::kNone);
  EXPECT_EQ(world().find(red)->solid->hash(), large_hash);
  EXPECT_EQ(replace(red, "feed").refusal, Refusal::kUnknownMesh);
}

// What was known of the distance of the old mesh says nothing of the new one, also where the part
// stands and others come from afar.
TEST_F(SceneEdit, NothingIsKnownOfTheDistancesOfAReplacedPart) {
  const PartId post = session.add("post", cube_mesh(10.0), at(0, 0, 480), false);
  world().state.reset();  // one of the larger scene
  ASSERT_EQ(session.grab(ada, far).refusal, Refusal::kNone);
  tick({session.push(ada, far, Vec3(0.5, 0, 0))});
  tick({session.push(ada, far, Vec3(0.5, 0, 0))});
  const Details larger = edit_of({"", larger_hash, {}, false, 0.0});
  ASSERT_EQ(refusal(ada, CommandKind::kReplacePart, post, larger), Refusal::kNone);
  EXPECT_TRUE(tick().events.empty());
  const StepReport report = tick({session.push(ada, far, Vec3(0, 0, -2))});
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].part_a, far);
  EXPECT_EQ(report.events[0].part_b, post);
}

// 5. counts

// Counts of pairs stay those of the parts that are there.
TEST_F(SceneEdit, PairsAreCountedOfWhatIsThere) {
  ASSERT_EQ(refusal(ada, CommandKind::kRemovePart, blue), Refusal::kNone);
  ASSERT_EQ(refusal(ada, CommandKind::kRemovePart, wall), Refusal::kNone);
  tick();
  ASSERT_EQ(session.grab(ada, red).refusal, Refusal::kNone);
  const StepCounters counters = tick({session.push(ada, red, Vec3(1, 0, 0))}).counters;
  EXPECT_EQ(counters.pairs.in, 1U);
  EXPECT_EQ(counters.pairs_boxes_apart, 1U);
  EXPECT_EQ(counters.pairs_static + counters.pairs_still, 0U);
}

// What depth derives of an added part is made beside the ticks, once for each thread that judges.
TEST(ReadyBody, IsTakenByOneThreadEach) {
  const Solid solid(cube_mesh(10.0));
  const SurfaceBand band = nominal_band();
  const auto in_thread = [](const auto& act) { std::thread(act).join(); };
  const auto is_ready = [&] {
    bool ready = false;
    in_thread([&] { ready = body_index(solid, band)->cover != nullptr; });
    return ready;
  };
  EXPECT_FALSE(is_ready());
  in_thread([&] { make_body_ready(solid, band, 2); });
  EXPECT_TRUE(is_ready());
  EXPECT_TRUE(is_ready());
  EXPECT_FALSE(is_ready()) << "there were two";
  const Solid other(cube_mesh(11.0));
  in_thread([&] { make_body_ready(other, band, 1); });
  EXPECT_FALSE(is_ready()) << "it is another part's";
}

}  // namespace
}  // namespace mortise
