// The program mortise-replay from outside: exit codes, text and JSON.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/golden/played_session.h"
#include "tests/support/programs.h"
#include "tests/unit/io/log_samples.h"

namespace mortise {
namespace {

using nlohmann::json;
using test::Outcome;
using test::TemporaryFile;

Outcome run(const std::string& arguments) { return test::run("mortise-replay", arguments); }

std::string quoted(const TemporaryFile& file) {
  return std::string("'").append(file.path().string()).append("'");
}

class ReplayProgram : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const std::string folder = std::string(MORTISE_SOURCE_DIR) + "/scenarios/thin_wall";
    auto session = test::play_session(folder + ".yaml", folder + ".play.yaml");
    ASSERT_TRUE(session) << session.error().text;
    session_ = std::make_unique<test::PlayedSession>(std::move(*session));
  }
  static void TearDownTestSuite() { session_.reset(); }
  void SetUp() override { ASSERT_NE(session_, nullptr); }
  static inline std::unique_ptr<test::PlayedSession> session_;
};

TEST_F(ReplayProgram, VerifiesATrueLog) {
  const TemporaryFile file("program.mcap");
  ASSERT_TRUE(test::write_log(*session_, file.path()));
  for (const char* threads : {"1", "2"}) {
    const Outcome outcome =
        run("verify --json --threads " + std::string(threads) + " " + quoted(file));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
    EXPECT_EQ(outcome.document()["verified"], true);
    EXPECT_EQ(outcome.document()["ticks_compared"], session_->ticks.size());
  }
  const Outcome report = run("report --json " + quoted(file));
  EXPECT_EQ(report.exit_code, 0);
  EXPECT_TRUE(report.document().contains("statistics")) << report.out;
  EXPECT_NE(run("report " + quoted(file)).out.find("wall × cube"), std::string::npos);
  const Outcome info = run("info --json " + quoted(file));
  EXPECT_EQ(info.exit_code, 0);
  EXPECT_EQ(info.document()["ticks"], session_->ticks.size());
  EXPECT_EQ(info.document()["complete"], true);
  EXPECT_NE(run("verify " + quoted(file)).out.find("verified: up to tick"), std::string::npos);
}

TEST_F(ReplayProgram, ExportLeavesTheLogAsItIs) {
  const TemporaryFile file("kept.mcap");
  ASSERT_TRUE(test::write_log(*session_, file.path()));
  const auto size = std::filesystem::file_size(file.path());
  for (const char* option : {"--json ", "--html ", "--csv "}) {
    const Outcome refused = run("export " + quoted(file) + " " + option + quoted(file));
    EXPECT_EQ(refused.exit_code, 2) << option;
    EXPECT_NE(refused.err.find("would overwrite the input"), std::string::npos) << refused.err;
    EXPECT_EQ(std::filesystem::file_size(file.path()), size);
  }
}

TEST_F(ReplayProgram, FourAtTheTickOfAChangedIncrement) {
  auto ticks = session_->ticks;
  std::uint64_t changed = 0;
  for (TickRecord& record : session_->ticks) {
    if (record.increments.empty()) continue;
    record.increments.front().translation_mm.y() += 1e-12;
    changed = record.tick;
    break;
  }
  const TemporaryFile file("program_changed.mcap");
  ASSERT_TRUE(test::write_log(*session_, file.path()));
  session_->ticks = std::move(ticks);
  const Outcome outcome = run("verify --json " + quoted(file));
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_EQ(outcome.document()["difference"]["tick"], changed) << outcome.out;
  EXPECT_EQ(run("verify " + quoted(file)).out.find("DIFFERENT at tick " + std::to_string(changed)),
            0u);
}

TEST_F(ReplayProgram, ThreeForABadLogAndTwoForBadUse) {
  const TemporaryFile file("program_bad.mcap"), missing("program_missing.mcap");
  std::ofstream(file.path()) << "no log";
  EXPECT_EQ(run("verify " + quoted(file)).exit_code, 3);
  EXPECT_EQ(run("info " + quoted(file)).exit_code, 3);
  EXPECT_EQ(run("recover " + quoted(file) + " --out " + quoted(missing)).exit_code, 3);
  EXPECT_EQ(run("verify " + quoted(missing)).exit_code, 3);
  EXPECT_EQ(run("verify").exit_code, 2);
  EXPECT_EQ(run("nonsense").exit_code, 2);
  EXPECT_EQ(run("--help").exit_code, 0);
}

TEST_F(ReplayProgram, RecoversALogWithoutTail) {
  const TemporaryFile file("program_cut.mcap"), whole("program_recovered.mcap");
  ASSERT_TRUE(test::write_log(*session_, file.path()));
  std::filesystem::resize_file(file.path(), std::filesystem::file_size(file.path()) - 100);
  EXPECT_EQ(run("info --json " + quoted(file)).document()["complete"], false);
  const Outcome outcome = run("recover --json " + quoted(file) + " --out " + quoted(whole));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_EQ(outcome.document()["was_complete"], false);
  EXPECT_FALSE(outcome.document()["notes"].empty());
  EXPECT_EQ(run("info --json " + quoted(whole)).document()["complete"], true);
  EXPECT_EQ(run("verify " + quoted(whole)).exit_code, 0);
  EXPECT_EQ(run("recover " + quoted(file) + " --out " + quoted(whole)).exit_code, 1)
      << "an existing file is never overwritten";
}

// A file that recover leaves behind can be opened and verified, wherever the log was cut; where
// that cannot be, there is no file.
TEST_F(ReplayProgram, RecoversOrLeavesNoFile) {
  const TemporaryFile file("program_whole.mcap"), cut("program_part.mcap");
  ASSERT_TRUE(test::write_log(*session_, file.path()));
  const auto size = std::filesystem::file_size(file.path());
  int recovered = 0, refused = 0;
  for (const int percent : {1, 3, 5, 8, 12, 20, 35, 50, 70, 90, 99}) {
    SCOPED_TRACE(percent);
    const TemporaryFile out("program_out.mcap");
    std::filesystem::copy_file(file.path(), cut.path(),
                               std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(cut.path(), size * static_cast<std::uintmax_t>(percent) / 100);
    const Outcome outcome = run("recover --json " + quoted(cut) + " --out " + quoted(out));
    if (outcome.exit_code == 0) {
      ++recovered;
      EXPECT_EQ(run("verify " + quoted(out)).exit_code, 0);
      EXPECT_EQ(outcome.document()["verified_to_tick"], outcome.document()["ticks"]);
    } else {
      ++refused;
      EXPECT_EQ(outcome.exit_code, 7);
      EXPECT_NE(outcome.document()["not_replayable"], "");
      EXPECT_FALSE(std::filesystem::exists(out.path()));
    }
  }
  EXPECT_GE(recovered, 2);
  EXPECT_GE(refused, 2);
}

// A sweep in two shards, put together, is the sweep.
TEST_F(ReplayProgram, ShardsOfASweepComeTogether) {
  const TemporaryFile file("sweep.mcap"), first("first.json"), second("second.json");
  ASSERT_TRUE(test::write_log(*session_, file.path()));
  const std::string sweep =
      "whatif --json --sweep 'policy = [stop, slide, report]' " + quoted(file);
  const Outcome whole = run(sweep);
  ASSERT_EQ(whole.exit_code, 0) << whole.out;
  ASSERT_EQ(whole.document()["variants"].size(), 3U);
  EXPECT_EQ(whole.document()["variants"][0]["changed"].size(), 0U);
  std::ofstream(first.path()) << run(sweep + " --shard 1/2").document();
  std::ofstream(second.path()) << run(sweep + " --shard 2/2").document();
  const Outcome merged = run("merge " + quoted(second) + " " + quoted(first));
  ASSERT_EQ(merged.exit_code, 0) << merged.out;
  EXPECT_EQ(merged.document(), whole.document());
  EXPECT_EQ(run("merge " + quoted(first)).exit_code, 3);
  EXPECT_EQ(run("merge " + quoted(file)).exit_code, 3);
  EXPECT_EQ(run(sweep + " --shard 3/2").exit_code, 2);
  EXPECT_EQ(run("whatif --set 'policy = bounce' " + quoted(file)).exit_code, 2);
}

}  // namespace
}  // namespace mortise
