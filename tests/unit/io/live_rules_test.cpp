// Tolerances, exclusions and policy that change while a session runs: the checks of the file, what
// becomes of open clashes, and that a log's replay goes the same way.
#include <gtest/gtest.h>

#include "common/io/log/replay.h"
#include "common/session/tick/step.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"
#include "tests/support/small_scenarios.h"
#include "tests/unit/io/log_samples.h"

namespace mortise {
namespace {

using test::TemporaryFile;

// Beside the peg a wall, 0.05 mm from the block.
const std::string kScenario = test::peg_yaml(R"(  - name: wall
    generator: {kind: block, x: 4, y: 40, z: 40}
    pose: {position: [104.05, 0, 0]}
)");

/// A session as a server would run it, recorded tick by tick.
struct LiveRules : testing::Test {
  LoadedScene scene;
  LogHeader header;
  std::vector<TickRecord> ticks;
  std::vector<Decision> decisions;
  Scratch scratch;
  UserId ann, bob;
  std::uint64_t seq = 0;
  PartId plate{1}, peg{2}, block{3}, wall{4};

  void SetUp() override {
    auto reading = read_scenario_text(kScenario, "live.yaml");
    ASSERT_TRUE(reading && reading->usable());
    auto loaded = load_scene(reading->scenario, default_meshes());
    ASSERT_TRUE(loaded && loaded->usable());
    scene = std::move(*loaded);
    header = log_header(scene, "live", "live.yaml", kScenario);
    for (const char* name : {"ann", "bob"}) {
      Decision join;
      join.kind = Decision::Kind::kJoin;
      join.user = UserId{static_cast<std::uint32_t>(decisions.size() + 1)};
      join.user_name = name;
      join.role = Role::kDesigner;
      apply_decision(scene.world, join);
      decisions.push_back(join);
    }
    ann = UserId{1}, bob = UserId{2};
  }

  Reply ask(UserId user, CommandKind kind, PartId part, Details details = {}) {
    Decision decision;
    Reply reply = apply_command(scene.world, {user, part, 1, kind, std::move(details)}, decision);
    if (reply.refusal == Refusal::kNone) decisions.push_back(decision);
    return reply;
  }
  Reply state(PartId part, const std::string& feature, const std::string& text,
              PartId other = PartId{}, const std::string& other_feature = "") {
    Details details;
    details.feature = feature;
    details.other_part = other;
    details.other_feature = other_feature;
    details.text = text;
    return ask(ann, CommandKind::kSetTolerance, part, std::move(details));
  }
  const StepReport& tick(const std::vector<Increment>& increments = {}) {
    TickRecord record;
    record.decisions = std::exchange(decisions, {});
    record.increments = increments;
    record.report = step(scene.world, increments, scratch);
    record.tick = record.report.tick;
    ticks.push_back(std::move(record));
    return ticks.back().report;
  }
  const StepReport& push(PartId part, const Vec3& by) {
    return tick({{ann, part, ++seq, by, Vec3::Zero()}});
  }
  /// The peg goes into its hole.
  void insert() {
    ask(ann, CommandKind::kGrab, peg);
    push(peg, Vec3(0, 0, -18));
  }
  CollisionClass class_now() const {
    const Snapshot snapshot = snapshot_of(scene.world);
    return snapshot.open_clashes.empty() ? CollisionClass::kNone
                                         : snapshot.open_clashes.front().verdict.collision_class;
  }
  void expect_replay_agrees() {
    const TemporaryFile file("live.mcap");
    auto writer = SessionLogWriter::create(file.path(), header);
    ASSERT_TRUE(writer);
    for (const TickRecord& record : ticks) (*writer)->record(record);
    ASSERT_TRUE((*writer)->close());
    const auto log = read_session_log(file.path());
    ASSERT_TRUE(log) << log.error().text;
    const auto report = verify(*log, 1);
    ASSERT_TRUE(report) << report.error().text;
    EXPECT_FALSE(report->difference) << report->difference->what;
    EXPECT_EQ(report->not_verifiable, "");
    EXPECT_EQ(report->ticks_compared, ticks.size());
  }
};

TEST_F(LiveRules, AFitChangedInMidSessionChangesTheClassAndSaysWhy) {
  insert();
  EXPECT_EQ(class_now(), CollisionClass::kFake);  // H7/g6
  const Reply reply = state(plate, "bore", "Ø20 H7/p6", peg, "journal");
  ASSERT_EQ(reply.refusal, Refusal::kNone) << reply.text;
  const StepReport& report = tick();
  EXPECT_EQ(class_now(), CollisionClass::kReal);
  ASSERT_FALSE(report.events.empty());
  bool told = false;
  for (const ClashEvent& event : report.events) {
    if (event.kind != ClashEvent::Kind::kChange) continue;
    told = true;
    EXPECT_EQ(event.verdict.collision_class, CollisionClass::kReal);
    EXPECT_EQ(event.cause, Decision::Kind::kSetTolerance);
    EXPECT_EQ(event.user, ann);
  }
  EXPECT_TRUE(told);
  EXPECT_EQ(state(plate, "bore", "H7/g6", peg, "journal").refusal, Refusal::kNone);
  tick();
  EXPECT_EQ(class_now(), CollisionClass::kFake);
  EXPECT_EQ(snapshot_of(scene.world).standing.size(), 1U);
  expect_replay_agrees();
}

TEST_F(LiveRules, ATolerancesOfAWholePartBringsNearPairsIn) {
  ask(ann, CommandKind::kGrab, block);
  EXPECT_TRUE(push(block, Vec3(0, 0, 1e-3)).events.empty());   // 50 um from the wall
  ASSERT_EQ(state(wall, "", "±0.1").refusal, Refusal::kNone);  // the one that does not move
  const StepReport& report = tick();
  ASSERT_EQ(report.events.size(), 1U);
  EXPECT_EQ(report.events[0].kind, ClashEvent::Kind::kBegin);
  EXPECT_EQ(report.events[0].cause, Decision::Kind::kSetTolerance);
  EXPECT_EQ(report.events[0].verdict.collision_class, CollisionClass::kPotential);
  ASSERT_EQ(state(wall, "", "").refusal, Refusal::kNone);
  ASSERT_EQ(tick().events.size(), 1U);
  EXPECT_EQ(ticks.back().report.events[0].kind, ClashEvent::Kind::kEnd);
  expect_replay_agrees();
}

// The fit of the file is told as a decision of nobody, until somebody decides about the same ends,
// whichever of them is named first.
TEST_F(LiveRules, WhatTheScenarioSaysStandsUntilSomebodyDecides) {
  std::vector<Decision> standing = snapshot_of(scene.world).standing;
  ASSERT_EQ(standing.size(), 1U);
  EXPECT_EQ(standing[0].kind, Decision::Kind::kSetTolerance);
  EXPECT_FALSE(standing[0].user);
  EXPECT_EQ(standing[0].part, plate);
  EXPECT_EQ(standing[0].details.other_part, peg);
  EXPECT_EQ(standing[0].details.feature, "bore");
  EXPECT_EQ(standing[0].details.other_feature, "journal");
  EXPECT_EQ(standing[0].details.text, "Ø20 H7/g6");
  ASSERT_EQ(state(peg, "journal", "H7/p6", plate, "bore").refusal, Refusal::kNone);
  standing = snapshot_of(scene.world).standing;
  ASSERT_EQ(standing.size(), 1U);
  EXPECT_EQ(standing[0].user, ann);
  EXPECT_EQ(standing[0].details.text, "H7/p6");
}

TEST_F(LiveRules, WhatContradictsIsRefusedWithTheSentenceOfTheFile) {
  insert();
  const std::uint64_t hash = ticks.back().report.state_hash;
  // In the file: the same two statements of one feature.
  std::string yaml = kScenario;
  const std::string feature = "chamfer_lower: {tolerance: {lower: -0.1, upper: -0.04}}";
  yaml.insert(yaml.find("    pose: {position: [0, 0, 25]}"), "    tolerance: {profile: 0.02}\n");
  auto reading = read_scenario_text(yaml, "live.yaml");
  ASSERT_TRUE(reading);
  const auto loaded = load_scene(reading->scenario, default_meshes());
  ASSERT_TRUE(loaded);
  std::string sentence;
  for (const Finding& finding : loaded->findings)
    if (finding.is_error && sentence.empty()) sentence = finding.text;
  ASSERT_NE(sentence.find("no surface satisfies both"), std::string::npos) << sentence;
  const Reply reply = state(peg, "", "{profile: 0.02}");
  EXPECT_EQ(reply.refusal, Refusal::kBadRule);
  EXPECT_NE(reply.text.find("no surface satisfies both"), std::string::npos) << reply.text;
  EXPECT_NE(reply.text.find("part peg: feature chamfer_lower: "), std::string::npos) << reply.text;
  EXPECT_NE(sentence.find("part peg: feature chamfer_lower: "), std::string::npos) << sentence;
  // Nothing has changed, and what is said next is taken.
  EXPECT_TRUE(scene.world.standing.empty());
  EXPECT_TRUE(tick().events.empty());
  EXPECT_EQ(class_now(), CollisionClass::kFake);
  EXPECT_NE(ticks.back().report.state_hash, hash);  // of another tick
  EXPECT_EQ(state(peg, "chamfer_lower", "{lower: -0.2, upper: -0.04}").refusal, Refusal::kNone);
  tick();
  expect_replay_agrees();
}

TEST_F(LiveRules, WhatIsNotUnderstoodIsRefused) {
  const auto refused = [&](PartId part, const std::string& feature, const std::string& text,
                           PartId other = PartId{}, const std::string& other_feature = "") {
    const Reply reply = state(part, feature, text, other, other_feature);
    EXPECT_FALSE(reply.text.empty());
    EXPECT_EQ(reply.text.find("tolerance:1"), std::string::npos) << reply.text;
    return reply.refusal;
  };
  EXPECT_EQ(refused(peg, "", "a lot"), Refusal::kBadRule);
  EXPECT_EQ(refused(peg, "", "±-1"), Refusal::kBadRule);
  EXPECT_EQ(refused(peg, "", "{profile: 0.1, colour: red}"), Refusal::kBadRule);
  EXPECT_EQ(refused(peg, "", "[1, 2"), Refusal::kBadRule);
  EXPECT_EQ(refused(peg, "", "~"), Refusal::kBadRule);
  EXPECT_EQ(refused(peg, "nose", "±0.1"), Refusal::kBadRule);
  EXPECT_EQ(refused(peg, "journal", "H7"), Refusal::kBadRule);  // a hole's class on a shaft
  EXPECT_EQ(refused(peg, "journal", "g99"), Refusal::kBadRule);
  EXPECT_EQ(refused(plate, "", "H7/g6", peg, ""), Refusal::kBadRule);
  EXPECT_EQ(refused(plate, "bore", "H7/g6", peg, "nose"), Refusal::kBadRule);
  EXPECT_EQ(refused(PartId{9}, "", "±0.1"), Refusal::kUnknownPart);
  EXPECT_EQ(refused(plate, "", "±0.1", plate), Refusal::kBadRule);
  EXPECT_TRUE(decisions.size() == 2U);  // the joins
}

// Every kind of decision in one session.
TEST_F(LiveRules, ALogWithAllDecisionsReplaysToTheSameHashes) {
  insert();
  const ClashId clash = snapshot_of(scene.world).open_clashes.at(0).clash;
  Details review;
  review.clash = clash;
  review.status = ReviewStatus::kApproved;
  review.text = "as drawn; Ø20";
  EXPECT_EQ(ask(bob, CommandKind::kReview, {}, review).refusal, Refusal::kNone);
  tick();
  EXPECT_EQ(state(plate, "bore", "H7/p6", peg, "journal").refusal, Refusal::kNone);
  const StepReport& worse = tick();
  EXPECT_TRUE(std::any_of(worse.events.begin(), worse.events.end(),
                          [](const ClashEvent& event) { return event.approval_lost; }));
  Details text;
  text.text = "stop";
  EXPECT_EQ(ask(ann, CommandKind::kSetPolicy, {}, text).refusal, Refusal::kNone);
  push(peg, Vec3(0, 0, -1));
  EXPECT_EQ(ask(bob, CommandKind::kAskHandOver, peg).refusal, Refusal::kNone);
  EXPECT_EQ(ask(ann, CommandKind::kDecline, peg, text).refusal, Refusal::kNone);
  EXPECT_EQ(ask(bob, CommandKind::kAskHandOver, peg).refusal, Refusal::kNone);
  tick();
  EXPECT_EQ(ask(ann, CommandKind::kConsent, peg).refusal, Refusal::kNone);
  tick();
  EXPECT_EQ(ask(bob, CommandKind::kRelease, peg).refusal, Refusal::kNone);
  EXPECT_EQ(ask(ann, CommandKind::kUndo, peg).refusal, Refusal::kNone);
  tick();
  EXPECT_EQ(ask(ann, CommandKind::kRedo, peg).refusal, Refusal::kNone);
  tick();
  Details pair;
  pair.other_part = plate;
  pair.text = "glued";
  EXPECT_EQ(ask(ann, CommandKind::kSetExclusion, peg, pair).refusal, Refusal::kNone);
  tick();
  EXPECT_EQ(ask(ann, CommandKind::kDropExclusion, peg, pair).refusal, Refusal::kNone);
  tick();
  Details group;
  group.parts = {peg, block};
  EXPECT_EQ(ask(ann, CommandKind::kGrab, {}, group).refusal, Refusal::kNone);
  push(block, Vec3(0, 0, 2));
  EXPECT_EQ(ask(ann, CommandKind::kRelease, {}, group).refusal, Refusal::kNone);
  EXPECT_EQ(ask(ann, CommandKind::kReset, peg).refusal, Refusal::kNone);
  tick();
  EXPECT_EQ(ask(ann, CommandKind::kGrab, peg).refusal, Refusal::kNone);
  Details coaxial;
  coaxial.constraint = {ConstraintKind::kCoaxial, {peg, "journal"}, {plate, "bore"}, 0.0, true};
  const Reply added = ask(ann, CommandKind::kAddConstraint, peg, coaxial);
  EXPECT_EQ(added.refusal, Refusal::kNone) << added.text;
  EXPECT_EQ(snapshot_of(scene.world).standing.size(), 4U);
  push(peg, Vec3(0.1, 0, -1));
  Details drop;
  drop.constraint_id = decisions.empty() ? ConstraintId{1} : ConstraintId{};
  EXPECT_EQ(ask(ann, CommandKind::kDropConstraint, peg, drop).refusal, Refusal::kNone);
  push(peg, Vec3(0.1, 0, -1));
  expect_replay_agrees();
}

// A replay that did not apply a change would be found out: the last decision of each kind left out.
TEST_F(LiveRules, AReplayWithoutTheChangeDisagrees) {
  insert();
  state(plate, "bore", "H7/p6", peg, "journal");
  tick();
  push(peg, Vec3(0, 0, -1));
  ticks.at(1).decisions.clear();
  const TemporaryFile file("planted.mcap");
  auto writer = SessionLogWriter::create(file.path(), header);
  ASSERT_TRUE(writer);
  for (const TickRecord& record : ticks) (*writer)->record(record);
  ASSERT_TRUE((*writer)->close());
  const auto log = read_session_log(file.path());
  ASSERT_TRUE(log);
  const auto report = verify(*log, 1);
  ASSERT_TRUE(report);
  ASSERT_TRUE(report->difference);
  EXPECT_EQ(report->difference->tick, 2U);
}

}  // namespace
}  // namespace mortise
