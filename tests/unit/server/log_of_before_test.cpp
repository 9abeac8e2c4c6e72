// Session logs as a version wrote them: tests/golden/before/VERSION. This build reads them, plays
// them again, and goes on from them. They are never written again; a new version adds its own:
// MORTISE_RECORD_LOGS_OF=VERSION writes them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "common/io/log/replay.h"
#include "common/io/scenario/open_scene.h"
#include "common/io/state/checkpoint.h"
#include "common/session/tick/step.h"
#include "common/session/world/commands.h"
#include "common/session/world/decisions.h"
#include "server/restore.h"
#include "server/standby.h"
#include "server/tick_bytes.h"
#include "tests/support/small_scenarios.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(MORTISE_SOURCE_DIR) / "tests/golden/before/0.2.0";
constexpr UserId kAnna{1}, kBen{2};
constexpr PartId kRed{2}, kBlue{3};

/// A session of two people that is written as it is played.
class Played {
 public:
  Played() {
    const std::string yaml = test::blocks_yaml();
    auto reading = read_scenario_text(yaml, "blocks.yaml");
    auto loaded = load_scene(reading->scenario, default_meshes());
    EXPECT_TRUE(loaded && loaded->usable());
    scene_ = std::move(*loaded);
    header_ = log_header(scene_, "default", "blocks.yaml", yaml);
    join(kAnna, "anna");
    join(kBen, "ben");
    tick();
  }
  void ask(UserId user, CommandKind kind, PartId part, const Details& details = {}) {
    Decision decision;
    const Reply reply =
        apply_command(scene_.world, {user, part, ++commands_, kind, details}, decision);
    EXPECT_EQ(reply.refusal, Refusal::kNone) << reply.text;
    decisions_.push_back(std::move(decision));
    tick();
  }
  void move(UserId user, PartId part, const Vec3& by_mm, const Vec3& turn_rad, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      increments_.push_back({user, part, ++seq_[user], by_mm, turn_rad});
      tick();
    }
  }
  void keep_state() { keeps_state_ = true; }
  void write(const fs::path& file) const {
    fs::create_directories(file.parent_path());
    ASSERT_FALSE(fs::exists(file)) << "is never written again";
    auto writer = SessionLogWriter::create(file, header_);
    ASSERT_TRUE(writer) << writer.error().text;
    for (const TickRecord& tick : ticks_) (*writer)->record(tick);
    ASSERT_TRUE((*writer)->close());
  }

 private:
  void join(UserId user, const char* name) {
    decisions_.push_back({Decision::Kind::kJoin, user, PartId{}, name, Role::kDesigner});
    apply_decision(scene_.world, decisions_.back());
  }
  void tick() {
    TickRecord record;
    record.decisions = std::exchange(decisions_, {});
    record.increments = std::exchange(increments_, {});
    record.report = step(scene_.world, record.increments, scratch_);
    record.tick = record.report.tick;
    record.time_ns = static_cast<std::int64_t>(record.tick) * 16'666'667;
    if (std::exchange(keeps_state_, false))
      record.state = [bytes = encode_state(scene_.world)] { return bytes; };
    ticks_.push_back(std::move(record));
  }

  LoadedScene scene_;
  LogHeader header_;
  Scratch scratch_{1};
  std::vector<TickRecord> ticks_;
  std::vector<Decision> decisions_;
  std::vector<Increment> increments_;
  std::map<UserId, std::uint64_t> seq_;
  std::uint64_t commands_ = 0;
  bool keeps_state_ = false;
};

Details said(const std::string& text) {
  Details details;
  details.text = text;
  return details;
}

/// All above the plate: no judgement is asked, and a later engine computes the same bits.
void moves(Played& session) {
  session.ask(kAnna, CommandKind::kGrab, kRed);
  session.move(kAnna, kRed, {0.5, 0.25, 0.125}, {0, 0, 0}, 16);
  session.ask(kBen, CommandKind::kGrab, kBlue);
  session.move(kBen, kBlue, {0, 0.5, 0.25}, {0, 0, 0}, 16);
  session.ask(kAnna, CommandKind::kRelease, kRed);
  session.keep_state();
  session.ask(kAnna, CommandKind::kUndo, kRed);
  session.ask(kAnna, CommandKind::kRedo, kRed);
  session.ask(kAnna, CommandKind::kAskHandOver, kBlue);
  session.ask(kBen, CommandKind::kConsent, kBlue);
  session.move(kAnna, kBlue, {0.25, 0, 0}, {0, 0, 0}, 8);
  session.ask(kAnna, CommandKind::kSetPolicy, PartId{}, said("slide"));
  session.ask(kBen, CommandKind::kSetTolerance, kRed, said("±0.05"));
}

/// Into the plate and out again, with a review.
void clashes(Played& session) {
  session.ask(kAnna, CommandKind::kGrab, kRed);
  session.move(kAnna, kRed, {0, 0, -1.5}, {0, 0, 0}, 8);  // 2 mm deep
  Details review = said("must not stay");
  review.clash = ClashId{1};
  review.status = ReviewStatus::kActive;
  session.ask(kBen, CommandKind::kReview, PartId{}, review);
  session.move(kAnna, kRed, {0, 0, 1.5}, {0, 0, 0}, 4);
  session.ask(kAnna, CommandKind::kRelease, kRed);
}

SessionLog log_of(const char* name, void (*play)(Played&)) {
  const fs::path file = kFolder / name;
  const char* version = std::getenv("MORTISE_RECORD_LOGS_OF");
  if (version != nullptr && kFolder.filename() == version) {
    Played session;
    play(session);
    session.write(file);
  }
  auto log = read_session_log(file);
  if (!log) {
    ADD_FAILURE() << log.error().text;
    return {};
  }
  EXPECT_TRUE(log->complete);
  EXPECT_TRUE(log->notes.empty()) << log->notes.front();
  EXPECT_TRUE(log->gaps.empty());
  EXPECT_EQ(log->session, "default");
  return std::move(*log);
}

void is_verified(const SessionLog& log) {
  const auto report = verify(log, 1);
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_FALSE(report->difference)
      << "tick " << report->difference->tick << ": " << report->difference->what;
  EXPECT_EQ(report->not_verifiable, "");
  EXPECT_EQ(report->ticks_compared, log.ticks.size());
}

// What was done is kept in numbers here: a log whose records are read as others is seen.
TEST(LogOfVersion, MovesOf020ArePlayedAgainAndGoneOnWith) {
  const SessionLog log = log_of("moves.mcap", moves);
  ASSERT_FALSE(HasFailure());
  ASSERT_EQ(log.ticks.size(), 50U);
  EXPECT_EQ(log.checkpoints.size(), 1U);
  is_verified(log);
  auto scene = scene_of(log);
  ASSERT_TRUE(scene) << scene.error().text;
  World& world = scene->world;
  const auto resumed = resume_from(log, world, 1);
  ASSERT_TRUE(resumed) << resumed.error().text;
  EXPECT_EQ(resumed->ticks, log.ticks.size());
  EXPECT_EQ(world.find(kRed)->X_WP.p, Vec3(8, 4, 22));
  EXPECT_EQ(world.find(kBlue)->X_WP.p, Vec3(32, 8, 24));
  ASSERT_EQ(world.users.size(), 2U);
  EXPECT_EQ(world.users[0].name, "anna");
  EXPECT_EQ(world.users[1].name, "ben");
  EXPECT_EQ(world.policy, Policy::kSlide);
  // It goes on: she comes back, is who she was, and takes back what she did before.
  apply_decision(world, {Decision::Kind::kJoin, kAnna, PartId{}, "anna", Role::kDesigner});
  Decision undo;
  const Reply reply = apply_command(world, {kAnna, kRed, 1, CommandKind::kUndo, {}}, undo);
  EXPECT_EQ(reply.refusal, Refusal::kNone) << reply.text;
  Scratch scratch(1);
  EXPECT_EQ(step(world, {}, scratch).tick, log.ticks.back().tick + 1);
  EXPECT_EQ(world.find(kRed)->X_WP.p, Vec3(0, 0, 20));
}

// One that stands by beside a leader of that version: what went into each of its ticks, and the
// hash that it had, in order.
TEST(LogOfVersion, TicksOf020AreFollowedInStep) {
  const auto read = read_session_log(kFolder / "moves.mcap");
  ASSERT_TRUE(read) << read.error().text;
  const SessionLog& log = *read;
  auto scene = scene_of(log);
  ASSERT_TRUE(scene) << scene.error().text;
  SessionStatistics statistics;
  Follower follower(scene->world, statistics, nullptr, 1);
  const auto told = [](const TickRecord& record) {
    FollowedTick tick;
    tick.tick = record.tick;
    tick.state_hash = record.report.state_hash;
    tick.time_ns = record.time_ns;
    tick.decisions = record.decisions;
    tick.increments = record.increments;
    return ToldTick{tick.tick, encode(tick)};
  };
  ASSERT_EQ(log.ticks.size(), 50U);
  for (std::size_t i = 0; i + 1 < log.ticks.size(); ++i) {
    const Status taken = follower.take(told(log.ticks[i]));
    ASSERT_TRUE(taken) << "tick " << log.ticks[i].tick << ": " << taken.error().text;
  }
  EXPECT_EQ(follower.ticks(), 49U);
  EXPECT_EQ(scene->world.find(kRed)->X_WP.p, Vec3(8, 4, 22));
  EXPECT_EQ(scene->world.find(kBlue)->X_WP.p, Vec3(32, 8, 24));
  TickRecord last = log.ticks.back();
  last.report.state_hash ^= 1;
  const Status differs = follower.take(told(last));
  ASSERT_FALSE(differs) << "each hash is compared";
  EXPECT_EQ(differs.error().code, Code::kMismatch);
}

// A later engine may judge with other bits: it says the same, within its accuracy.
TEST(LogOfVersion, ClashesOf020ArePlayedAgain) {
  const SessionLog log = log_of("clashes.mcap", clashes);
  ASSERT_FALSE(HasFailure());
  is_verified(log);
  std::vector<ClashEvent> events;
  for (const TickRecord& tick : log.ticks)
    events.insert(events.end(), tick.report.events.begin(), tick.report.events.end());
  ASSERT_GE(events.size(), 3U);
  EXPECT_EQ(events.front().kind, ClashEvent::Kind::kBegin);
  EXPECT_EQ(events.back().kind, ClashEvent::Kind::kEnd);
  EXPECT_NEAR(events.front().verdict.delta_mm.hi, 0.5, 1e-6) << "in the first tick";
  std::size_t reviews = 0;
  for (const ClashEvent& event : events) {
    EXPECT_EQ(event.clash, ClashId{1});
    EXPECT_EQ(event.part_a, PartId{1});
    EXPECT_EQ(event.part_b, kRed);
    if (event.kind != ClashEvent::Kind::kReview) continue;
    ++reviews;
    EXPECT_EQ(event.review.user, kBen);
    EXPECT_EQ(event.review.status, ReviewStatus::kActive);
    EXPECT_EQ(event.review.comment, "must not stay");
  }
  EXPECT_EQ(reviews, 1U);
}

}  // namespace
}  // namespace mortise
