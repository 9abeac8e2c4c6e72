// Recorded sessions whose answers are kept in this folder: who changes an answer sees it here. With
// MORTISE_GOLDEN=write in the environment the files are written anew instead; the difference is
// then to be read like any other change.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "common/base/hash.h"
#include "common/io/build_info.h"
#include "common/io/log/replay.h"
#include "common/messages/names.h"
#include "tests/golden/played_session.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;
const fs::path kSource = MORTISE_SOURCE_DIR;
const fs::path kGolden = kSource / "tests" / "golden";

bool is_writing() {
  const char* mode = std::getenv("MORTISE_GOLDEN");
  return mode != nullptr && std::string(mode) == "write";
}

std::string rounded(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.6f", value + 0.0);
  return text.data();
}

// What a session answers, for people to read in a comparison.
std::string answers_of(const test::PlayedSession& session) {
  std::ostringstream out;
  const auto name = [&](PartId part) { return session.scene.world.find(part)->name; };
  out << "ticks " << session.ticks.size() << '\n';
  for (const TickRecord& record : session.ticks) {
    for (const RefusedIncrement& refused : record.report.refused)
      out << "tick " << record.tick << " refused: " << name_of(refused.reason) << '\n';
    for (const ClashEvent& event : record.report.events)
      out << "tick " << event.tick << ' ' << name_of(event.kind) << ' ' << name(event.part_a)
          << " - " << name(event.part_b) << ": " << name_of(event.verdict.collision_class)
          << ", overlap " << rounded(event.verdict.delta_mm.lo) << " mm, worst "
          << name_of(event.worst_class) << '\n';
  }
  for (const Part& part : session.scene.world.parts)
    if (part.moving)
      out << "end " << part.name << ' ' << rounded(part.X_WP.p.x()) << ' '
          << rounded(part.X_WP.p.y()) << ' ' << rounded(part.X_WP.p.z()) << '\n';
  return out.str();
}

// Every state of the session in one number; promised for one build only.
std::string bits_of(const test::PlayedSession& session) {
  StateHash hash;
  for (const TickRecord& record : session.ticks) hash.add(record.report.state_hash);
  std::ostringstream out;
  out << "bits " << toolchain_fingerprint() << ' ' << std::hex << hash.value() << '\n';
  return out.str();
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

#define NEEDS_GOLDEN_TOOLCHAIN(golden)                                                       \
  if ((golden).find("bits " + toolchain_fingerprint()) == std::string::npos)                 \
  GTEST_SKIP() << "toolchain: another compiler or flags than the golden ones, bits are not " \
                  "compared"

// Short plays: what is kept is the answers, not the time that they take. thin_wall plays its own.
struct Case {
  const char* name;
  const char* scenario;
  const char* policy;
  const char* play;
};
const Case kCases[] = {
    {"thin_wall", "thin_wall", "stop", nullptr},
    {"peg_in_hole", "peg_in_hole", "report", R"(
acts:
  - {user: ann, part: peg_g6, steps: [{by: [0, 0, -18], seconds: 0.05}, {seconds: 0.05}, {by: [0, 0, 18], seconds: 0.034}]}
  - {user: bob, part: peg_k6, steps: [{by: [0, 0, -18], seconds: 0.05}, {seconds: 0.05}, {by: [0, 0, 18], seconds: 0.034}]}
  - {user: cid, part: peg_p6, steps: [{by: [0, 0, -18], seconds: 0.05}, {seconds: 0.05}, {by: [0, 0, 18], seconds: 0.034}]}
)"},
    // Against the wall and on along it, past its rim, back across it, and down it turning.
    {"thin_wall_slide", "thin_wall", "slide", R"(
acts:
  - {user: ann, part: cube, steps: [{by: [8, 4, 1], seconds: 0.2}, {by: [2, -9, 3], seconds: 0.2},
     {by: [0, 0, 14], seconds: 0.2}, {by: [2, 0, 0], seconds: 0.1}, {by: [-6, 1, -12], rotate_deg: [0, 20, 0], seconds: 0.3}]}
)"},
    // Down onto the plate beside the bore and across its face; off the mouth of a bore that is
    // tight.
    {"peg_in_hole_slide", "peg_in_hole", "slide", R"(
acts:
  - {user: ann, part: peg_g6, steps: [{by: [3, 1, -9], seconds: 0.1}, {by: [-3, -1, -4], seconds: 0.1}]}
  - {user: cid, part: peg_p6, steps: [{by: [0, 0, -9], seconds: 0.1}, {by: [4, 0, -4], seconds: 0.1}]}
)"},
    {"blocks_profile", "blocks_profile", "report", R"(
acts:
  - {user: ann, part: overlap_200, steps: [{by: [0, 0, 1], seconds: 0.05}, {by: [0, 0, -1], seconds: 0.05}]}
  - {user: bob, part: overlap_50, steps: [{by: [0, 0, 1], seconds: 0.05}, {by: [0, 0, -1], seconds: 0.05}]}
  - {user: cid, part: gap_50, steps: [{by: [0, 0, 1], seconds: 0.05}, {by: [0, 0, -1], seconds: 0.05}]}
  - {user: dan, part: gap_200, steps: [{by: [0, 0, 1], seconds: 0.05}, {by: [0, 0, -1], seconds: 0.05}]}
)"},
};

Result<test::PlayedSession> play_case(const Case& one) {
  const fs::path scenarios = kSource / "scenarios";
  const std::string scenario = one.scenario;
  const auto play = one.play == nullptr
                        ? read_play(scenarios / (scenario + ".play.yaml"))
                        : read_play_text(one.play, std::string(one.name) + " of golden_test.cpp");
  if (!play) return play.error();
  const std::string yaml = text_of(scenarios / (scenario + ".yaml"));
  const std::size_t at = yaml.find("\npolicy: ") + 1, end = yaml.find('\n', at);
  return test::play_session(std::string(one.name) + ".yaml",
                            yaml.substr(0, at) + "policy: " + one.policy + yaml.substr(end), *play);
}

class Golden : public testing::TestWithParam<Case> {};

TEST_P(Golden, AnswersStayAsTheyAre) {
  const std::string name = GetParam().name;
  const auto session = play_case(GetParam());
  ASSERT_TRUE(session) << session.error().text;
  const std::string answers = answers_of(*session);
  const fs::path file = kGolden / (name + ".txt");
  if (is_writing()) {
    std::ofstream(file) << answers << bits_of(*session);
    return;
  }
  const std::string golden = text_of(file);
  ASSERT_FALSE(golden.empty()) << file << " is missing; write it with MORTISE_GOLDEN=write";
  const std::size_t bits_at = golden.rfind("bits ");
  ASSERT_NE(bits_at, std::string::npos);
  EXPECT_EQ(answers, golden.substr(0, bits_at));
}

TEST_P(Golden, BitsStayAsTheyAre) {
  if (is_writing()) return;
  const std::string golden = text_of(kGolden / (std::string(GetParam().name) + ".txt"));
  NEEDS_GOLDEN_TOOLCHAIN(golden);
  const auto session = play_case(GetParam());
  ASSERT_TRUE(session) << session.error().text;
  EXPECT_EQ(bits_of(*session), golden.substr(golden.rfind("bits ")));
}

INSTANTIATE_TEST_SUITE_P(, Golden, testing::ValuesIn(kCases),
                         [](const auto& one) { return std::string(one.param.name); });

// The comparison must be able to fail: one answer changed by a micrometre.
TEST(GoldenCheck, SeesAPlantedChange) {
  auto session = play_case(kCases[0]);
  ASSERT_TRUE(session) << session.error().text;
  const std::string answers = answers_of(*session), bits = bits_of(*session);
  session->scene.world.parts.back().X_WP.p.x() += 1e-3;
  EXPECT_NE(answers_of(*session), answers);
  session->ticks.front().report.state_hash ^= 1;
  EXPECT_NE(bits_of(*session), bits);
}

// Logs of this format stay readable, and the same build computes them again bit for bit.
class GoldenLog : public testing::TestWithParam<Case> {};

TEST_P(GoldenLog, ReadsAndReplays) {
  const std::string name = GetParam().name;
  const fs::path file = kGolden / (name + ".mcap");
  if (is_writing()) {
    const auto session = play_case(GetParam());
    ASSERT_TRUE(session) << session.error().text;
    fs::remove(file);
    ASSERT_TRUE(test::write_log(*session, file));
    return;
  }
  const auto log = read_session_log(file);
  ASSERT_TRUE(log) << log.error().text;
  EXPECT_TRUE(log->complete);
  EXPECT_TRUE(log->notes.empty());
  EXPECT_GT(log->ticks.size(), 10u);
  const auto report = verify(*log, 2);
  ASSERT_TRUE(report) << report.error().text;
  NEEDS_GOLDEN_TOOLCHAIN(text_of(kGolden / (name + ".txt")));
  EXPECT_FALSE(report->difference)
      << "tick " << report->difference->tick << ": " << report->difference->what;
}

INSTANTIATE_TEST_SUITE_P(, GoldenLog, testing::Values(kCases[0], kCases[2]),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace mortise
