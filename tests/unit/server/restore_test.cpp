#include "server/restore.h"
#include "common/io/log/log_chain.h"
#include "common/session/world/decisions.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "common/io/log/replay.h"
#include "common/session/tick/step.h"
#include "server/clock.h"
#include "tests/golden/played_session.h"
#include "tests/support/test_folder.h"

namespace mortise {
namespace {

using test::play_session;
using test::PlayedSession;
using test::TestFolder;
using test::write_log;

class Restore : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path scenarios = std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios";
    auto played = play_session(scenarios / "peg_in_hole.yaml", scenarios / "peg_in_hole.play.yaml");
    ASSERT_TRUE(played) << played.error().text;
    session_ = std::make_unique<PlayedSession>(std::move(*played));
    const auto file = folder_.path() / "whole.mcap";
    ASSERT_TRUE(write_log(*session_, file));
    auto log = read_session_log(file);
    ASSERT_TRUE(log) << log.error().text;
    log_ = std::move(*log);
  }
  SessionLog first(std::size_t ticks) const {
    SessionLog log = log_;
    log.ticks.resize(ticks);
    log.complete = false;
    return log;
  }

  TestFolder folder_;
  std::unique_ptr<PlayedSession> session_;
  SessionLog log_;
};

// Who held what takes it again; then the rest of the session must be what it was without a break.
TEST_F(Restore, FromAnyTickTheSessionGoesOnAsIfNothingHadBeen) {
  const std::size_t all = log_.ticks.size();
  ASSERT_GT(all, 100U);
  std::size_t with_clash = 0, with_holder = 0;
  for (const std::size_t k : {std::size_t{1}, all / 5, all / 3, all / 2, 2 * all / 3, all - 1}) {
    auto scene = scene_of(log_);
    ASSERT_TRUE(scene) << scene.error().text;
    World& world = scene->world;
    std::map<PartId, UserId> held;  // as the log has it
    std::uint64_t event_seq = 0;
    for (std::size_t i = 0; i < k; ++i) {
      for (const Decision& d : log_.ticks[i].decisions) {
        if (d.kind == Decision::Kind::kGrab) held[d.part] = d.user;
        if (d.kind == Decision::Kind::kRelease) held.erase(d.part);
      }
      for (const ClashEvent& event : log_.ticks[i].report.events) event_seq = event.seq;
    }
    auto resumed = resume_from(first(k), world, 1);
    ASSERT_TRUE(resumed) << resumed.error().text;
    EXPECT_EQ(resumed->ticks, k);
    EXPECT_EQ(resumed->ticks_left_out, 0U);
    EXPECT_EQ(world.tick, log_.ticks[k - 1].tick);
    EXPECT_EQ(snapshot_of(world).event_seq, event_seq);
    EXPECT_EQ(resumed->statistics.ticks(), k);
    EXPECT_EQ(resumed->departures.size(), world.users.size());
    with_clash += snapshot_of(world).open_clashes.empty() ? 0 : 1;
    with_holder += held.empty() ? 0 : 1;
    for (const Part& part : world.parts) EXPECT_FALSE(part.holder) << part.name;
    for (const User& user : world.users) EXPECT_FALSE(user.present) << user.name;

    for (const User& user : world.users)
      apply_decision(world, {Decision::Kind::kJoin, user.id, PartId{}, user.name});
    for (const auto& [part, user] : held)
      apply_decision(world, {Decision::Kind::kGrab, user, part, ""});
    Scratch scratch(1);
    for (std::size_t i = k; i < all; ++i) {
      const TickRecord& record = log_.ticks[i];
      for (const Decision& decision : record.decisions) apply_decision(world, decision);
      const StepReport report = step(world, record.increments, scratch);
      ASSERT_EQ(report.state_hash, record.report.state_hash)
          << "restored at " << k << ", tick " << record.tick;
      ASSERT_EQ(report.events.size(), record.report.events.size());
      for (std::size_t e = 0; e < report.events.size(); ++e) {
        EXPECT_EQ(report.events[e].seq, record.report.events[e].seq);
        EXPECT_EQ(report.events[e].clash, record.report.events[e].clash);
      }
    }
  }
  EXPECT_GE(with_clash, 1U) << "no restore with an open clash: this shows too little";
  EXPECT_GE(with_holder, 2U);
}

TEST_F(Restore, TheNextLogGoesOnFromThere) {
  const std::size_t k = log_.ticks.size() / 2;
  auto scene = scene_of(log_);
  ASSERT_TRUE(scene);
  auto resumed = resume_from(first(k), scene->world, 1);
  ASSERT_TRUE(resumed) << resumed.error().text;
  ASSERT_TRUE(resumed->begin);
  EXPECT_EQ(resumed->begin->state.tick, log_.ticks[k - 1].tick);
  EXPECT_EQ(resumed->begin->state.state_hash, log_.ticks[k - 1].report.state_hash);
  LogHeader header = session_->header;
  header.begin = std::move(resumed->begin);
  header.chain = {"whole.mcap", 2};
  const auto file = folder_.path() / "next.mcap";
  auto writer = SessionLogWriter::create(file, header);
  ASSERT_TRUE(writer) << writer.error().text;
  // On disk now, though the log is still open and nothing has happened.
  EXPECT_TRUE(read_session_log(file));
  TickRecord record;
  record.decisions = resumed->departures;
  Scratch scratch(1);
  record.report = step(scene->world, {}, scratch);
  (*writer)->record(record);
  ASSERT_TRUE((*writer)->close());
  // Alone, and behind the one before, of which what was not gone on from is left out.
  for (const auto& log : {read_session_log(file), read_session(folder_.path() / "whole.mcap")}) {
    ASSERT_TRUE(log) << log.error().text;
    const auto report = verify(*log, 1);
    ASSERT_TRUE(report) << report.error().text;
    EXPECT_FALSE(report->difference) << report->difference->what;
    EXPECT_EQ(report->not_verifiable, "");
    EXPECT_EQ(report->verified_to_tick, log_.ticks[k - 1].tick + 1);
    EXPECT_EQ(report->ticks_compared, log->begin ? 1 : k + 1);
  }
}

TEST_F(Restore, ALogThatThisEngineDoesNotComputeIsRefused) {
  SessionLog log = first(50);
  log.ticks[20].report.state_hash ^= 1;
  auto scene = scene_of(log);
  ASSERT_TRUE(scene);
  const auto resumed = resume_from(log, scene->world, 1);
  ASSERT_FALSE(resumed);
  EXPECT_EQ(resumed.error().code, Code::kMismatch);
  EXPECT_NE(resumed.error().text.find("tick 21"), std::string::npos) << resumed.error().text;
}

TEST_F(Restore, WhatLiesBehindAGapIsLeftOutAndCounted) {
  SessionLog log = first(60);
  log.ticks.erase(log.ticks.begin() + 40, log.ticks.begin() + 45);
  log.gaps.push_back({40, 46, "the queue to the disk was full"});
  auto scene = scene_of(log);
  ASSERT_TRUE(scene);
  const auto resumed = resume_from(log, scene->world, 1);
  ASSERT_TRUE(resumed) << resumed.error().text;
  EXPECT_EQ(scene->world.tick, 40U);
  EXPECT_EQ(resumed->ticks, 40U);
  EXPECT_EQ(resumed->ticks_left_out, 15U);
  EXPECT_NE(resumed->left_out_because.find("queue"), std::string::npos);
}

TEST_F(Restore, WhatMayBeMissingBehindTheLastTickIsSaid) {
  const auto missing = [](const SessionLog& log) {
    auto scene = scene_of(log);
    EXPECT_TRUE(scene);
    const auto resumed = resume_from(log, scene->world, 1);
    EXPECT_TRUE(resumed) << resumed.error().text;
    EXPECT_EQ(resumed->ticks_left_out, 0U);
    return resumed->missing_at_end;
  };
  SessionLog log = first(30);
  log.complete = true;
  EXPECT_EQ(missing(log), "");
  log.complete = false;
  EXPECT_EQ(
      missing(log),
      "the log was not closed properly; it ends at tick 30, and what came after is not known");
  // It was closed, and a chunk was cut out of its end.
  log.complete = true;
  log.gaps.push_back({30, 0, "20 ticks that it states are not there", true});
  EXPECT_EQ(missing(log), "ticks after 30 are missing: 20 ticks that it states are not there");
}

TEST(LogToRestore, IsTheNewestOfTheSessionAndNoOther) {
  TestFolder folder;
  EXPECT_TRUE(logs_to_restore(folder.path(), "demo").empty());
  for (const char* name :
       {"demo-20260101-120000.mcap", "demo-20260101-120000_1.mcap", "demo-20251231-235959.mcap",
        "demo-2-20270101-000000.mcap", "demo-20280101-000000.mcap.begun", "demo-notes.txt"})
    folder.write(name, "x");
  const auto files = logs_to_restore(folder.path(), "demo");
  ASSERT_EQ(files.size(), 3U);
  EXPECT_EQ(files[0].filename(), "demo-20260101-120000_1.mcap");
  EXPECT_EQ(files[1].filename(), "demo-20260101-120000.mcap");
  EXPECT_EQ(files[2].filename(), "demo-20251231-235959.mcap");
  EXPECT_EQ(logs_to_restore(folder.path(), "demo-2").at(0).filename(),
            "demo-2-20270101-000000.mcap");
  EXPECT_TRUE(logs_to_restore(folder.path(), "other").empty());
  EXPECT_EQ(logs_to_restore(folder.path() / "x.mcap", "demo").at(0), folder.path() / "x.mcap");
}

// A file of the future is one of before the clock was set back.
TEST(LogToRestore, OfThoseWrittenIsTheLastOneOfNow) {
  namespace fs = std::filesystem;
  TestFolder folder;
  const auto now = fs::file_time_type::clock::now();
  const auto written = [&](const char* name, std::chrono::seconds after_now) {
    fs::last_write_time(folder.write(name, "x"), now + after_now);
  };
  using std::chrono::hours;
  written("demo-20260101-130000.mcap", hours(1));
  written("demo-20260101-110000.mcap", -hours(1));
  written("demo-20260101-120000.mcap", std::chrono::seconds(0));
  const auto files = logs_to_restore(folder.path(), "demo", Newest::kWritten);
  ASSERT_EQ(files.size(), 3U);
  EXPECT_EQ(files[0].filename(), "demo-20260101-120000.mcap");
  EXPECT_EQ(files[2].filename(), "demo-20260101-130000.mcap");
}

TEST_F(Restore, TheNextLogKnowsWhenItsSessionWasLed) {
  auto scene = scene_of(log_);
  ASSERT_TRUE(scene) << scene.error().text;
  const auto resumed = resume_from(log_, scene->world, 1);
  ASSERT_TRUE(resumed && resumed->begin) << "nothing was told";
  EXPECT_GT(last_time_ns(log_), 0);
  EXPECT_EQ(resumed->begin->time_ns, last_time_ns(log_));
  LogHeader header = log_header(*scene, "default", log_.scenario_name, log_.scenario_yaml);
  header.begin = resumed->begin;
  header.chain = {"whole.mcap", 2};
  // Also one that was killed before its first tick came to disk.
  const auto file = folder_.path() / "next.mcap";
  auto writer = SessionLogWriter::create(file, header);
  ASSERT_TRUE(writer) << writer.error().text;
  ASSERT_TRUE((*writer)->close());
  const auto next = read_session_log(file);
  ASSERT_TRUE(next) << next.error().text;
  EXPECT_TRUE(next->ticks.empty());
  EXPECT_EQ(last_time_ns(*next), last_time_ns(log_));
}

TEST(SystemClockSays, NoTimeBeforeTheOneItIsGiven) {
  constexpr std::int64_t kHour_ns = 3'600'000'000'000;
  SystemClock plain;
  const std::int64_t later_ns = plain.wall_ns() + kHour_ns;
  SystemClock clock(later_ns);
  const std::int64_t first_ns = clock.wall_ns();
  EXPECT_GE(first_ns, later_ns);
  EXPECT_NEAR(clock.ahead_s(), 3600.0, 60.0);
  clock.sleep_until_ns(clock.now_ns() + 2'000'000);
  EXPECT_GE(clock.wall_ns(), first_ns + 2'000'000) << "it goes on";
  SystemClock past(later_ns - 2 * kHour_ns);
  EXPECT_LT(past.wall_ns(), later_ns) << "the machine's, where that is later";
  EXPECT_NEAR(past.ahead_s(), 0.0, 1.0);
}

// A damaged number in a log must not keep a start busy for ever.
TEST_F(Restore, ATickFarAheadIsDamageAndNoPause) {
  const auto file = folder_.path() / "gap.mcap";
  const std::uint64_t last = session_->ticks.back().tick;
  session_->ticks.back().tick = session_->ticks.back().report.tick = std::uint64_t{1} << 56;
  ASSERT_TRUE(write_log(*session_, file));
  const auto log = read_session_log(file);
  ASSERT_TRUE(log) << log.error().text;
  EXPECT_LT(log->ticks.back().tick, last);
  ASSERT_FALSE(log->gaps.empty());
  EXPECT_NE(log->gaps.back().reason.find("does not follow"), std::string::npos);
  auto scene = scene_of(*log);
  ASSERT_TRUE(scene);
  const auto resumed = resume_from(*log, scene->world, 1);
  ASSERT_TRUE(resumed) << resumed.error().text;
  EXPECT_EQ(scene->world.tick, log->ticks.back().tick);
}

// A night of ticks without a record may be true: whoever does not want to wait may stop it.
TEST_F(Restore, IsStoppedWithinTicksThatNobodyLogged) {
  const auto file = folder_.path() / "night.mcap";
  constexpr std::int64_t kNight_s = 8 * 3600;
  session_->ticks.back().report.tick = session_->ticks.back().tick += 60 * kNight_s;
  session_->ticks.back().time_ns += kNight_s * 1'000'000'000;
  ASSERT_TRUE(write_log(*session_, file));
  const auto log = read_session_log(file);
  ASSERT_TRUE(log) << log.error().text;
  EXPECT_TRUE(log->gaps.empty());
  auto scene = scene_of(*log);
  ASSERT_TRUE(scene);
  int asked = 0;
  const auto resumed = resume_from(*log, scene->world, 1, true, [&] { return ++asked == 1000; });
  ASSERT_FALSE(resumed);
  EXPECT_NE(resumed.error().text.find("stopped while it was played again"), std::string::npos);
  EXPECT_EQ(asked, 1000);
}

// A number alone is no night: its times tell how long nothing happened.
TEST_F(Restore, ATickFarAheadOfItsTimeIsNotComputedUpTo) {
  const auto file = folder_.path() / "number.mcap";
  session_->ticks.back().report.tick = session_->ticks.back().tick += 80'000'000;
  ASSERT_TRUE(write_log(*session_, file));
  const auto log = read_session_log(file);
  ASSERT_TRUE(log) << log.error().text;
  auto scene = scene_of(*log);
  ASSERT_TRUE(scene);
  int asked = 0;
  const auto resumed = resume_from(*log, scene->world, 1, true, [&] { return ++asked, false; });
  ASSERT_FALSE(resumed);
  EXPECT_NE(resumed.error().text.find("the log is damaged"), std::string::npos);
  EXPECT_LT(asked, 1000);
}

// What a log tells of ticks without a record is what computing them tells.
TEST_F(Restore, IdleTicksCountAllAtOnce) {
  SessionStatistics one_by_one, at_once;
  for (const TickRecord& record : log_.ticks) {
    one_by_one.add(record.report);
    at_once.add(record.report);
    if (record.tick % 20 != 0) continue;
    for (int i = 0; i < 7; ++i) one_by_one.add({});
    at_once.add_idle(7);
  }
  EXPECT_EQ(at_once.ticks(), one_by_one.ticks());
  ASSERT_EQ(at_once.clashes().size(), one_by_one.clashes().size());
  ASSERT_FALSE(at_once.clashes().empty());
  for (const auto& [id, clash] : at_once.clashes())
    for (int c = 0; c < 4; ++c) EXPECT_EQ(clash.ticks[c], one_by_one.clashes().at(id).ticks[c]);
}

}  // namespace
}  // namespace mortise
