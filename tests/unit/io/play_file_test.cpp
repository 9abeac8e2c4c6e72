#include "common/io/scenario/play_file.h"

#include <gtest/gtest.h>

#include <numbers>

namespace mortise {
namespace {

TEST(PlayFile, ReadsActs) {
  const auto play = read_play_text(R"(
acts:
  - user: anna
    part: shaft
    at: 1.5
    steps:
      - {by: [0, 0, -40], seconds: 2}
      - {rotate_deg: [0, 0, 180], seconds: 1}
    release: false
)",
                                   "p.yaml");
  ASSERT_TRUE(play) << play.error().text;
  ASSERT_EQ(play->acts.size(), 1U);
  const Play::Act& act = play->acts[0];
  EXPECT_EQ(act.user, "anna");
  EXPECT_EQ(act.part, "shaft");
  EXPECT_EQ(act.at_s, 1.5);
  EXPECT_FALSE(act.release);
  ASSERT_EQ(act.steps.size(), 2U);
  EXPECT_EQ(act.steps[0].by_mm, Vec3(0, 0, -40));
  EXPECT_NEAR(act.steps[1].rotate_rad.z(), std::numbers::pi, 1e-15);
  EXPECT_EQ(play->seconds(), 4.5);
}

TEST(PlayFile, EachFaultIsOneLineWithItsPlace) {
  const struct {
    const char* yaml;
    const char* place;
    const char* says;
  } faults[] = {
      {"acts: [", "p.yaml:", "not YAML"},
      {"", "p.yaml:1", "acts"},
      {"acts: []", "p.yaml:1", "at least one"},
      {"acts:\n  - {user: a, part: b}", "p.yaml:2", "steps"},
      {"acts:\n  - {part: b, steps: [{seconds: 1}]}", "p.yaml:2", "'user' is missing"},
      {"acts:\n  - {user: a, part: b, steps: [{by: [1, 2], seconds: 1}]}", "p.yaml:2", "three"},
      {"acts:\n  - {user: a, part: b, steps: [{by: [1, 2, x], seconds: 1}]}", "p.yaml:2", "finite"},
      {"acts:\n  - {user: a, part: b, steps: [{by: [1, 2, .nan], seconds: 1}]}", "p.yaml:2",
       "finite"},
      {"acts:\n  - {user: a, part: b, steps: [{seconds: 0}]}", "p.yaml:2", "above zero"},
      {"acts:\n  - {user: a, part: b, steps: [{by: [1, 2, 3]}]}", "p.yaml:2", "seconds"},
      {"acts:\n  - {user: a, part: b, at: -1, steps: [{seconds: 1}]}", "p.yaml:2", "negative"},
      {"acts:\n  - user: a\n    part: b\n    speed: 3\n    steps: [{seconds: 1}]", "p.yaml:4",
       "unknown key 'speed'"},
      {"acts: [{user: a, part: b, steps: [{seconds: 1}]}]\nloop: true", "p.yaml:2", "loop"},
      {"acts: [{user: a, part: b, steps: [{seconds: 1}]}]\nacts: []", "p.yaml:2", "'acts' stands"},
      {"acts:\n  - {user: a,\n     part: b, user: c, steps: [{seconds: 1}]}", "p.yaml:3", "'user'"},
      {"acts: [{user: a, part: b, steps: [{seconds: 1, seconds: 2}]}]", "p.yaml:1", "twice"},
      {"acts: [{user: a, part: b, steps: [{seconds: 1}]}]\n---\nacts: []", "p.yaml",
       "more than one document"},
      {"? [acts]\n: 1", "p.yaml:1", "a key must be a word"},
  };
  for (const auto& fault : faults) {
    const auto play = read_play_text(fault.yaml, "p.yaml");
    ASSERT_FALSE(play) << fault.yaml;
    const std::string& text = play.error().text;
    EXPECT_TRUE(text.starts_with(fault.place)) << text;
    EXPECT_NE(text.find(fault.says), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

TEST(PlayFile, AMissingFileIsSaidSo) {
  const auto play = read_play("/nowhere/x.play.yaml");
  ASSERT_FALSE(play);
  EXPECT_NE(play.error().text.find("/nowhere/x.play.yaml"), std::string::npos);
}

TEST(PlayFile, TextsAndNumbersHaveARange) {
  const auto play = [](const std::string& user, const std::string& step) {
    return read_play_text("acts:\n  - {user: " + user + ", part: p, steps: [" + step + "]}\n", "p");
  };
  EXPECT_TRUE(play("ann", "{by: [1, 0, 0], seconds: 1}"));
  EXPECT_FALSE(play("ann", "{by: [1e15, 0, 0], seconds: 1}"));
  EXPECT_FALSE(play("ann", "{seconds: 1e300}"));
  EXPECT_FALSE(play("J\xe4ger", "{seconds: 1}"));
  EXPECT_FALSE(play(R"("a\nb")", "{seconds: 1}"));
}

}  // namespace
}  // namespace mortise
