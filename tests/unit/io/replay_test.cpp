#include "common/io/log/replay.h"

#include <gtest/gtest.h>

#include "common/io/log/log_json.h"
#include "tests/golden/played_session.h"
#include "tests/unit/io/log_samples.h"

namespace mortise {
namespace {

using test::play_session;
using test::PlayedSession;
using test::TemporaryFile;
using test::write_log;

// A block is pushed into a wall and past it, turned, and pulled back; another user leaves it alone.
constexpr const char* kWall = R"(
name: wall
units: mm
policy: stop
max_jump: 20
parts:
  - name: wall
    generator: {kind: block, x: 1, y: 40, z: 40}
    pose: {position: [20, 0, 0]}
  - name: block
    generator: {kind: block, x: 4, y: 4, z: 4}
    pose: {position: [0, 0, 0]}
    moving: true
)";
constexpr const char* kPlay = R"(
acts:
  - user: ann
    part: block
    steps:
      - {by: [30, 1, 0], seconds: 0.5}
      - {seconds: 0.3}
      - {rotate_deg: [0, 0, 30], seconds: 0.25}
      - {by: [-30, 0, 0.5], seconds: 0.5}
  - {user: bob, part: block, at: 2, steps: [{by: [5, 5, 5], seconds: 0.2}]}
)";

class Replay : public testing::Test {
 protected:
  void SetUp() override {
    const auto play = read_play_text(kPlay, "wall.play.yaml");
    ASSERT_TRUE(play) << play.error().text;
    auto session = play_session("wall.yaml", kWall, *play);
    ASSERT_TRUE(session) << session.error().text;
    session_ = std::make_unique<PlayedSession>(std::move(*session));
  }
  SessionLog logged(const PlayedSession& session) {
    const TemporaryFile file("replay.mcap");
    const Status written = write_log(session, file.path());
    EXPECT_TRUE(written);
    auto log = read_session_log(file.path());
    EXPECT_TRUE(log);
    return std::move(*log);
  }
  TickRecord& tick(std::uint64_t number) { return session_->ticks.at(number - 1); }

  std::unique_ptr<PlayedSession> session_;
};

std::uint64_t first_with_increments(const PlayedSession& session) {
  for (const TickRecord& tick : session.ticks)
    if (!tick.increments.empty()) return tick.tick;
  return 0;
}

TEST_F(Replay, AgreesBitForBitAtAnyNumberOfThreads) {
  std::size_t events = 0;
  for (const TickRecord& record : session_->ticks) events += record.report.events.size();
  ASSERT_GT(events, 0u) << "nothing touched the wall: this session shows nothing";
  const SessionLog log = logged(*session_);
  for (const int threads : {1, 2}) {
    const auto report = verify(log, threads);
    ASSERT_TRUE(report) << report.error().text;
    EXPECT_FALSE(report->difference) << report->difference->tick << report->difference->what;
    EXPECT_EQ(report->not_verifiable, "");
    EXPECT_EQ(report->verified_to_tick, session_->ticks.size());
    EXPECT_EQ(report->ticks_compared, session_->ticks.size());
    EXPECT_EQ(report->events_compared, events);
    EXPECT_TRUE(report->same_build);
  }
}

TEST_F(Replay, ComputesTicksThatWereNotRecorded) {
  const std::size_t all = session_->ticks.size();
  std::erase_if(session_->ticks, [](const TickRecord& record) {
    return record.increments.empty() && record.decisions.empty() && record.report.events.empty();
  });
  ASSERT_LT(session_->ticks.size(), all);
  const auto report = verify(logged(*session_), 1);
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_FALSE(report->difference) << report->difference->what;
  EXPECT_EQ(report->idle_ticks + report->ticks_compared, report->verified_to_tick);
}

TEST_F(Replay, NamesTheTickOfAChangedIncrement) {
  const std::uint64_t changed = first_with_increments(*session_) + 3;
  tick(changed).increments.at(0).translation_mm.y() += 1e-12;  // far below any accuracy
  const auto report = verify(logged(*session_), 1);
  ASSERT_TRUE(report) << report.error().text;
  ASSERT_TRUE(report->difference);
  EXPECT_EQ(report->difference->tick, changed);
  EXPECT_EQ(report->verified_to_tick, changed - 1);
  EXPECT_NE(report->difference->what.find("state hash"), std::string::npos);
}

TEST_F(Replay, NamesThePartThatIsElsewhere) {
  const std::uint64_t changed = first_with_increments(*session_) + 3;
  tick(changed).increments.at(0).translation_mm.y() += 0.5;
  const auto report = verify(logged(*session_), 1);
  ASSERT_TRUE(report);
  ASSERT_TRUE(report->difference);
  EXPECT_NE(report->difference->what.find("part block is 0.5"), std::string::npos)
      << report->difference->what;
}

TEST_F(Replay, NamesAChangedEvent) {
  for (TickRecord& record : session_->ticks) {
    if (record.report.events.empty()) continue;
    record.report.events.front().verdict.delta_mm.lo += 1e-9;
    const auto report = verify(logged(*session_), 1);
    ASSERT_TRUE(report);
    ASSERT_TRUE(report->difference);
    EXPECT_EQ(report->difference->tick, record.tick);
    EXPECT_NE(report->difference->what.find("delta_mm"), std::string::npos);
    return;
  }
  FAIL() << "the session has no event";
}

TEST_F(Replay, NamesALostDecision) {
  for (TickRecord& record : session_->ticks)
    std::erase_if(record.decisions,
                  [](const Decision& d) { return d.kind == Decision::Kind::kGrab; });
  const auto report = verify(logged(*session_), 1);
  ASSERT_TRUE(report);
  ASSERT_TRUE(report->difference);
  EXPECT_LE(report->difference->tick, first_with_increments(*session_));
}

TEST_F(Replay, SaysWhereAGapEndsIt) {
  SessionLog log = logged(*session_);
  const std::uint64_t lost = first_with_increments(*session_) + 5;
  log.ticks.erase(log.ticks.begin() + static_cast<std::ptrdiff_t>(lost - 1));
  log.gaps.push_back({lost - 1, lost + 1, "the queue to the disk was full"});
  const auto report = verify(log, 1);
  ASSERT_TRUE(report);
  EXPECT_FALSE(report->difference);
  EXPECT_EQ(report->verified_to_tick, lost - 1);
  EXPECT_NE(report->not_verifiable.find("queue"), std::string::npos);
}

TEST_F(Replay, RefusesALogThatCannotBeReplayed) {
  SessionLog log = logged(*session_);
  SessionLog no_mesh = log;
  no_mesh.meshes.clear();
  no_mesh.mesh_of_part.front() = "of no mesh that anybody makes";
  EXPECT_FALSE(verify(no_mesh, 1));
  SessionLog bad_scenario = log;
  bad_scenario.scenario_yaml = "name: [";
  EXPECT_FALSE(verify(bad_scenario, 1));
  SessionLog bad_tick = log;
  bad_tick.ticks.back().tick = UINT64_MAX;
  EXPECT_FALSE(verify(bad_tick, 1));
}

// The hash of a mesh is in the log beside it: a generator makes it again, or another one, which is
// seen.
TEST_F(Replay, MakesLostMeshesOfGeneratorsAgain) {
  SessionLog log = logged(*session_);
  ASSERT_FALSE(log.meshes.empty());
  log.meshes.clear();
  const auto report = verify(log, 1);
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_FALSE(report->difference);
  EXPECT_EQ(report->ticks_compared, session_->ticks.size());
}

// Other last bits, and so other hashes, are no difference; what a designer would notice is.
TEST_F(Replay, OfAnotherBuildIsHeldToAccuracy) {
  const std::uint64_t changed = first_with_increments(*session_) + 3;
  const auto verified = [&] {
    SessionLog log = logged(*session_);
    log.build_fingerprint = "another";
    auto report = verify(log, 1);
    EXPECT_TRUE(report) << report.error().text;
    EXPECT_FALSE(report->bit_for_bit);
    return std::move(*report);
  };
  tick(changed).increments.at(0).translation_mm.y() += 1e-9;
  const ReplayReport close = verified();
  EXPECT_FALSE(close.difference) << close.difference->what;
  EXPECT_EQ(close.ticks_compared, session_->ticks.size());
  EXPECT_LT(close.largest_pose_off_mm, 1e-5);

  tick(changed).increments.at(0).translation_mm.y() += 0.01;
  const ReplayReport off = verified();
  ASSERT_TRUE(off.difference);
  EXPECT_EQ(off.difference->tick, changed);
  EXPECT_NE(off.difference->what.find("mm from where"), std::string::npos) << off.difference->what;
  tick(changed).increments.at(0).translation_mm.y() -= 0.01;

  for (TickRecord& record : session_->ticks)
    for (ClashEvent& event : record.report.events)
      event.verdict.collision_class = CollisionClass::kFake;
  EXPECT_TRUE(verified().difference);
}

}  // namespace
}  // namespace mortise
