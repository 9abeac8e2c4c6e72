// Checkpoints in a log, logs in several files, and what becomes of both when they are damaged or
// their writer is killed.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <future>

#include "common/io/log/log_chain.h"
#include "common/io/log/replay.h"
#include "common/session/memory/session_state.h"
#include "tests/support/effort.h"
#include "tests/support/test_folder.h"
#include "tests/unit/io/random_session.h"
#include "tests/unit/io/slow_file.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;
using test::RandomSession;
using test::SlowFile;
using test::TestFolder;

bool write_tick(int to, std::uint64_t tick) { return ::write(to, &tick, sizeof tick) < 0; }

constexpr std::size_t kTicks = 200, kEvery = 20;

/// A random session whose ticks know the state after every 20th of them.
class LogChain : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    session_ = new RandomSession(10);
    for (std::size_t i = 1; i <= kTicks; ++i) {
      session_->tick();
      if (i % kEvery != 0) continue;
      session_->ticks.back().state = [bytes = encode_state(session_->scene.world)] {
        return bytes;
      };
    }
  }
  static void TearDownTestSuite() {
    delete session_;
    session_ = nullptr;
  }
  fs::path file(const std::string& name) const { return folder_.path() / name; }
  void write(const fs::path& name, const LogOptions& options = {}) {
    auto writer = SessionLogWriter::create(name, session_->header, options);
    ASSERT_TRUE(writer) << writer.error().text;
    for (const TickRecord& tick : session_->ticks) {
      (*writer)->record(tick);
      if (tick.state) {
        ASSERT_TRUE((*writer)->flush());
      }
    }
    ASSERT_TRUE((*writer)->close());
  }
  std::vector<fs::path> files(const std::string& extension = ".mcap") const {
    std::vector<fs::path> all;
    for (const auto& entry : fs::directory_iterator(folder_.path()))
      if (entry.path().extension() == extension) all.push_back(entry.path());
    std::sort(all.begin(), all.end());
    return all;
  }
  static void expect_verified(const SessionLog& log, std::size_t ticks, std::size_t checkpoints) {
    const auto report = verify(log, 1);
    ASSERT_TRUE(report) << report.error().text;
    EXPECT_FALSE(report->difference)
        << report->difference->tick << ": " << report->difference->what;
    EXPECT_EQ(report->not_verifiable, "");
    EXPECT_EQ(report->ticks_compared, ticks);
    EXPECT_EQ(report->checkpoints_compared, checkpoints);
  }

  static RandomSession* session_;
  TestFolder folder_;
};
RandomSession* LogChain::session_ = nullptr;

TEST_F(LogChain, VerifyHoldsEveryCheckpointAgainstItsOwnState) {
  write(file("one.mcap"));
  const auto log = read_session_log(file("one.mcap"));
  ASSERT_TRUE(log) << log.error().text;
  ASSERT_EQ(log->checkpoints.size(), kTicks / kEvery);
  for (const Checkpoint& state : log->checkpoints) EXPECT_TRUE(state.bytes.empty());
  expect_verified(*log, kTicks, kTicks / kEvery);
}

// Neither its hash nor anything that was told would show it: only the comparison of all bytes does.
TEST_F(LogChain, ACheckpointThatForgetsOneThingIsFound) {
  const std::size_t at = 5 * kEvery - 1;
  const TickRecord whole = session_->ticks[at];
  auto scene = test::random_scene();
  ASSERT_TRUE(restore_state(scene->world, whole.state()));
  ASSERT_FALSE(scene->world.state->memos.empty());
  scene->world.state->saved_work += 1;
  session_->ticks[at].state = [bytes = encode_state(scene->world)] { return bytes; };
  write(file("planted.mcap"));
  session_->ticks[at] = whole;
  const auto log = read_session_log(file("planted.mcap"));
  ASSERT_TRUE(log) << log.error().text;
  const auto report = verify(*log, 1);
  ASSERT_TRUE(report) << report.error().text;
  ASSERT_TRUE(report->difference);
  EXPECT_EQ(report->difference->tick, at + 1);
  EXPECT_NE(report->difference->what.find("checkpoint"), std::string::npos);
}

TEST_F(LogChain, TheLastCheckpointOfUseIsTheStart) {
  write(file("one.mcap"));
  const auto log = read_session_log(file("one.mcap"), {.keep_checkpoints = 2});
  ASSERT_TRUE(log) << log.error().text;
  const auto goes_on = [&](const SessionLog& damaged, std::uint64_t from, std::size_t notes) {
    auto at = scene_at_last_checkpoint(damaged);
    ASSERT_TRUE(at) << at.error().text;
    EXPECT_EQ(at->tick, from);
    EXPECT_EQ(at->from_checkpoint, from > 0);
    EXPECT_EQ(at->notes.size(), notes) << (notes ? at->notes.front() : "");
    const auto report = replay(at->scene.world, damaged, 1);
    ASSERT_TRUE(report) << report.error().text;
    EXPECT_FALSE(report->difference) << report->difference->what;
    EXPECT_EQ(report->ticks_compared, kTicks - from);
  };
  SessionLog shorter = *log;  // so that there is something left to compute
  shorter.checkpoints.pop_back();
  goes_on(*log, kTicks, 0);
  goes_on(shorter, kTicks - kEvery, 0);
  SessionLog damaged = *log;
  damaged.checkpoints.back().bytes.resize(100);
  goes_on(damaged, kTicks - kEvery, 1);
  for (Checkpoint& state : damaged.checkpoints) state.build = "another";
  goes_on(damaged, 0, 2);
}

/// Of a server that stands by: its files have their names when it leads, or go with it.
TEST_F(LogChain, FilesThatAreNamedLaterAreNamedTogetherOrGo) {
  const LogOptions options = {.chunk_bytes = 4096, .rotate_bytes = 20'000, .named_later = true};
  write(file("s.mcap"), options);
  EXPECT_TRUE(fs::is_empty(folder_.path())) << "closed without a name";

  auto writer = SessionLogWriter::create(file("s.mcap"), session_->header, options);
  ASSERT_TRUE(writer) << writer.error().text;
  for (const TickRecord& tick : session_->ticks) {
    (*writer)->record(tick);
    if (!tick.state) continue;
    ASSERT_TRUE((*writer)->flush());
    if (tick.tick != kTicks / 2) continue;
    EXPECT_TRUE(files().empty());
    EXPECT_GE(files(".begun").size(), 2U);
    ASSERT_TRUE((*writer)->take_name());
    EXPECT_GE(files().size(), 2U);
    EXPECT_TRUE(files(".begun").empty());
  }
  ASSERT_TRUE((*writer)->close());
  EXPECT_GE(files().size(), 4U);
  EXPECT_EQ(chain_from(file("s.mcap")), files());
  const auto whole = read_session(file("s.mcap"));
  ASSERT_TRUE(whole) << whole.error().text;
  expect_verified(*whole, kTicks, kTicks / kEvery);
}

/// A take-over must not wait for the disk that a next file is begun on.
TEST_F(LogChain, NamesAreGivenWhileTheDiskIsSlow) {
  const LogOptions options = {.chunk_bytes = 4096, .rotate_bytes = 20'000, .named_later = true};
  auto writer = SessionLogWriter::create(file("s.mcap"), session_->header, options);
  ASSERT_TRUE(writer) << writer.error().text;
  SlowFile slow("s_p0002.mcap.begun");
  for (const TickRecord& tick : session_->ticks) (*writer)->record(tick);
  ASSERT_TRUE(slow.is_waited_for(20.0)) << "the log was not rotated";
  auto named = std::async(std::launch::async, [&] { return (*writer)->take_name(); });
  EXPECT_EQ(named.wait_for(std::chrono::seconds(5)), std::future_status::ready);
  slow.go_on();
  EXPECT_TRUE(named.get());
  ASSERT_TRUE((*writer)->close());
  EXPECT_TRUE(files(".begun").empty());
  EXPECT_EQ(chain_from(file("s.mcap")), files());
  const auto whole = read_session(file("s.mcap"));
  ASSERT_TRUE(whole) << whole.error().text;
  EXPECT_EQ(whole->ticks.size(), kTicks);
}

/// Two that stand by, with one disk between them, may choose one name in the same second.
TEST_F(LogChain, AFileWithoutItsNameThatIsBeingWrittenIsLeftAlone) {
  const LogOptions options = {.named_later = true};
  auto writer = SessionLogWriter::create(file("s.mcap"), session_->header, options);
  ASSERT_TRUE(writer) << writer.error().text;
  const auto second = SessionLogWriter::create(file("s.mcap"), session_->header, options);
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().text.find("it exists already"), std::string::npos);
  for (const TickRecord& tick : session_->ticks) (*writer)->record(tick);
  ASSERT_TRUE((*writer)->take_name());
  ASSERT_TRUE((*writer)->close());
  const auto whole = read_session(file("s.mcap"));
  ASSERT_TRUE(whole) << whole.error().text;
  EXPECT_EQ(whole->ticks.size(), kTicks);
  // What a start that was cut short left is nobody's.
  std::ofstream(file("t.mcap.begun")) << "cut short";
  ASSERT_TRUE(SessionLogWriter::create(file("t.mcap"), session_->header, options));
}

/// Of several files one cannot be named: the others are, and none is removed.
TEST_F(LogChain, AFileThatCannotBeNamedTakesNoOtherWithIt) {
  const LogOptions options = {.chunk_bytes = 4096, .rotate_bytes = 20'000, .named_later = true};
  auto writer = SessionLogWriter::create(file("s.mcap"), session_->header, options);
  ASSERT_TRUE(writer) << writer.error().text;
  for (const TickRecord& tick : session_->ticks) {
    (*writer)->record(tick);
    if (tick.state) (void)(*writer)->flush();
  }
  const std::size_t begun = files(".begun").size();
  ASSERT_GE(begun, 4U);
  fs::remove(file("s.mcap.begun"));  // somebody tidied up
  EXPECT_FALSE((*writer)->take_name());
  ASSERT_TRUE((*writer)->close());
  EXPECT_EQ(files().size(), begun - 1);
  EXPECT_TRUE(files(".begun").empty());
}

TEST_F(LogChain, EachFileStandsAloneAndAllTogether) {
  write(file("s.mcap"), {.chunk_bytes = 4096, .rotate_bytes = 20'000});
  const std::vector<fs::path> all = files();
  ASSERT_GE(all.size(), 4U) << "the log was hardly rotated: this shows little";
  EXPECT_EQ(all[1].filename(), "s_p0002.mcap");
  EXPECT_EQ(chain_from(file("s.mcap")), all);
  std::size_t ticks = 0;
  SessionStatistics sums;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto log = read_session_log(all[i]);
    ASSERT_TRUE(log) << log.error().text;
    EXPECT_TRUE(log->complete);
    EXPECT_EQ(log->begin.has_value(), i > 0);
    expect_verified(*log, log->ticks.size(), log->checkpoints.size());
    if (log->begin) {
      EXPECT_EQ(log->begin->state.tick, ticks);
      EXPECT_EQ(log->begin->statistics.ticks(), sums.ticks());
      EXPECT_EQ(log->begin->statistics.clashes().size(), sums.clashes().size());
      EXPECT_EQ(log->begin->statistics.counters().depth_evaluations,
                sums.counters().depth_evaluations);
    }
    for (const TickRecord& tick : log->ticks) sums.add(session_->ticks[tick.tick - 1].report);
    ticks += log->ticks.size();
  }
  EXPECT_EQ(ticks, kTicks);
  const auto whole = read_session(file("s.mcap"));
  ASSERT_TRUE(whole) << whole.error().text;
  expect_verified(*whole, kTicks, kTicks / kEvery);
  const auto later = read_session(all[2]);
  ASSERT_TRUE(later) << later.error().text;
  EXPECT_EQ(later->ticks.back().tick, kTicks);
  const auto report = verify(*later, 1);
  ASSERT_TRUE(report) << report.error().text;
  EXPECT_FALSE(report->difference) << report->difference->what;
}

TEST_F(LogChain, AMissingFileIsAGapAndForeignOnesAreRefused) {
  write(file("s.mcap"), {.chunk_bytes = 4096, .rotate_bytes = 20'000});
  std::vector<fs::path> all = files();
  ASSERT_GE(all.size(), 4U);
  const std::vector<fs::path> without{all[0], all[2]};
  const auto log = read_session(without);
  ASSERT_TRUE(log) << log.error().text;
  ASSERT_EQ(log->gaps.size(), 1U);
  const auto report = verify(*log, 1);
  ASSERT_TRUE(report);
  EXPECT_FALSE(report->difference);
  EXPECT_NE(report->not_verifiable.find("are missing"), std::string::npos);
  EXPECT_FALSE(read_session(std::vector<fs::path>{all[2], all[1]})) << "the wrong way round";
  EXPECT_FALSE(read_session(std::vector<fs::path>{all[1], all[0]})) << "the first is no follower";
}

// What was on disk stays, whenever the writer dies; most of these files are very small.
TEST_F(LogChain, AKillWhileFilesChangeLosesNothingThatWasFlushed) {
  std::mt19937_64 random(3);
  std::size_t most_files = 0;
  for (int round = 0; round < (test::timed() ? 40 : 6); ++round) {
    const fs::path folder = file("kill" + std::to_string(round));
    fs::create_directories(folder);
    int flushed_pipe[2];
    ASSERT_EQ(pipe(flushed_pipe), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      auto writer = SessionLogWriter::create(folder / "s.mcap", session_->header,
                                             {.chunk_bytes = 4096, .rotate_bytes = 30'000});
      for (const TickRecord& tick : session_->ticks) {
        (*writer)->record(tick);
        if (tick.tick % 4 != 0) continue;
        if (!(*writer)->flush()) _exit(1);
        if (write_tick(flushed_pipe[1], tick.tick)) _exit(1);
      }
      pause();
    }
    close(flushed_pipe[1]);
    // A disk takes as long as it likes: the kill comes some time after so much was flushed.
    const std::uint64_t enough = 1 + random() % (kTicks - 4);
    std::uint64_t flushed = 0, tick = 0;
    while (flushed < enough && read(flushed_pipe[0], &tick, sizeof tick) == sizeof tick)
      flushed = tick;
    usleep(static_cast<useconds_t>(random() % 10'000));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    while (read(flushed_pipe[0], &tick, sizeof tick) == sizeof tick) flushed = tick;
    close(flushed_pipe[0]);
    ASSERT_GE(flushed, enough) << "the writer ended by itself";
    most_files = std::max(most_files, chain_from(folder / "s.mcap").size());
    const auto log = read_session(folder / "s.mcap");
    ASSERT_TRUE(log) << log.error().text;
    const std::uint64_t last = log->ticks.empty() ? 0 : log->ticks.back().tick;
    EXPECT_GE(last, flushed);
    EXPECT_EQ(log->ticks.size(), last);
    const auto report = verify(*log, 1);
    ASSERT_TRUE(report) << report.error().text;
    EXPECT_FALSE(report->difference) << report->difference->what;
    EXPECT_EQ(report->verified_to_tick, last);
  }
  EXPECT_GE(most_files, 3U) << "no kill came while files changed";
}

}  // namespace
}  // namespace mortise
