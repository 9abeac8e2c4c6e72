#include "server/metrics_text.h"

#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "common/messages/memory_channel.h"
#include "tests/unit/server/small_world.h"

namespace mortise {
namespace {

using namespace mortise::testing;

struct Exposition {
  std::map<std::string, std::string> values;  ///< by name and labels
  std::map<std::string, std::string> kinds;
};

// The format as its own documents give it, read strictly.
Exposition read(const std::string& text) {
  static const std::regex help("# HELP ([a-z_]+) \\S.*");
  static const std::regex type("# TYPE ([a-z_]+) (counter|gauge|histogram)");
  static const std::regex sample(
      "([a-z_]+)(\\{[a-z_]+=\"(?:[^\"\\\\\n]|\\\\.)*\"(?:,[a-z_]+=\"(?:[^\"\\\\\n]|\\\\.)*\")*\\})?"
      " ([-+0-9.e]+|inf|nan)");
  // What a sample of a histogram adds to the name of its family.
  static const std::regex part("(_bucket|_sum|_count)$");
  Exposition read;
  std::istringstream lines(text);
  std::string line, family, helped;
  std::smatch m;
  while (std::getline(lines, line)) {
    if (std::regex_match(line, m, help)) {
      helped = m[1];
    } else if (std::regex_match(line, m, type)) {
      family = m[1];
      EXPECT_EQ(helped, family);
      EXPECT_TRUE(read.kinds.emplace(family, m[2]).second) << "told twice: " << family;
    } else if (std::regex_match(line, m, sample)) {
      const bool histogram = read.kinds[family] == "histogram";
      EXPECT_EQ(histogram ? std::regex_replace(m[1].str(), part, "") : m[1].str(), family)
          << "a sample outside of its family";
      EXPECT_TRUE(read.values.emplace(m[1].str() + m[2].str(), m[3]).second) << line;
    } else {
      ADD_FAILURE() << "no line of this format: " << line;
    }
  }
  for (const auto& [name, kind] : read.kinds)
    EXPECT_EQ(kind == "counter", name.ends_with("_total")) << name;
  return read;
}

TEST(MetricsText, TellsWhatTheSessionKnows) {
  MemoryHub hub;
  World world = small_world();
  world.policy = Policy::kReport;
  auto channel = hub.open_server();
  SystemClock clock;
  TickLoop loop(world, *channel, clock, nullptr, {});
  loop.open();
  auto anna = hub.open_client(), ben = hub.open_client();
  anna->join(1, "anna \"the\\hand\"", "designer");
  loop.tick();
  ben->join(1, "ben", "designer");
  loop.tick();
  const UserId a{1}, b{2};
  anna->send(Command{a, kRed, 1, CommandKind::kGrab});
  ben->send(Command{b, kRed, 1, CommandKind::kGrab});  // refused
  loop.tick();
  const auto move = [](const UserId user, std::uint64_t seq, double x_mm) {
    return Increment{user, kRed, seq, {x_mm, 0, 0}, Vec3::Zero()};
  };
  anna->send(batch_of(move(a, 1, -6), 0));
  anna->send(batch_of(move(a, 4, -6), 0));  // 2 and 3 were lost
  anna->send(batch_of(move(a, 4, -6), 0));  // a repeat
  ben->send(batch_of(move(b, 1, 1), 0));    // not the holder
  loop.tick();

  Backlog follower;
  for (const std::uint64_t behind : {1, 40, 12}) (void)follower.now_is(behind);
  const Exposition told =
      read(metrics_text(figures_of(loop, channel->counters(), "a\nb", follower), 4096));
  const std::string whole = metrics_text(figures_of(loop, channel->counters(), "a"), 4096);
  const std::map<std::string, std::string> expected = {
      {"mortise_session_info{session=\"a\\nb\",policy=\"report\"}", "1"},
      {"mortise_ticks_total", "4"},
      {"mortise_users", "2"},
      {"mortise_increments_total", "4"},
      {"mortise_increments_accepted_total", "2"},
      {"mortise_increments_refused_total{reason=\"duplicate sequence\"}", "1"},
      {"mortise_commands_refused_total", "1"},
      {"mortise_user_increments_total{user=\"anna \\\"the\\\\hand\\\"\"}", "3"},
      {"mortise_user_increments_lost_total{user=\"anna \\\"the\\\\hand\\\"\"}", "2"},
      {"mortise_user_increments_refused_total{user=\"anna \\\"the\\\\hand\\\"\"}", "1"},
      {"mortise_user_parts_held{user=\"anna \\\"the\\\\hand\\\"\"}", "1"},
      {"mortise_user_increments_accepted_total{user=\"ben\"}", "0"},
      {"mortise_user_increments_refused_total{user=\"ben\"}", "1"},
      {"mortise_user_commands_refused_total{user=\"ben\"}", "1"},
      {"mortise_clashes_open{class=\"real\"}", "1"},
      {"mortise_clashes_total{class=\"real\"}", "1"},
      {"mortise_standby_in_step", "0"},
      {"mortise_standby_ticks_behind", "12"},
      {"mortise_standby_most_ticks_behind", "40"},
      {"mortise_standby_fell_behind_total", "1"},
      {"mortise_log_open", "0"},
      {"process_resident_memory_bytes", "4096"},
  };
  for (const auto& [name, value] : expected) {
    ASSERT_TRUE(told.values.contains(name)) << name << "\n" << whole;
    EXPECT_EQ(told.values.at(name), value) << name;
  }
  EXPECT_EQ(told.kinds.at("mortise_tick_seconds"), "histogram");
  EXPECT_EQ(told.values.at("mortise_tick_seconds_bucket{le=\"+Inf\"}"), "4");
  EXPECT_EQ(told.values.at("mortise_tick_seconds_count"), "4");
  EXPECT_GT(std::stod(told.values.at("mortise_tick_seconds_sum")), 0.0);
  EXPECT_GT(resident_bytes(), 1'000'000U);
}

TEST(MetricsText, ToldDurationsAreCumulative) {
  SessionFigures figures;
  figures.tick_s.count = 9;
  figures.tick_s.sum_s = 0.25;
  for (std::size_t i = 0; i < kDurationBounds_s.size(); ++i) figures.tick_s.up_to[i] = i / 2;
  const std::string text = metrics_text(figures, 0);
  EXPECT_NE(text.find("# TYPE mortise_tick_seconds histogram\n"
                      "mortise_tick_seconds_bucket{le=\"5e-05\"} 0\n"
                      "mortise_tick_seconds_bucket{le=\"0.0001\"} 0\n"
                      "mortise_tick_seconds_bucket{le=\"0.00025\"} 1\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("mortise_tick_seconds_bucket{le=\"1\"} 7\n"
                      "mortise_tick_seconds_bucket{le=\"+Inf\"} 9\n"
                      "mortise_tick_seconds_sum 0.25\n"
                      "mortise_tick_seconds_count 9\n"),
            std::string::npos)
      << text;
}

}  // namespace
}  // namespace mortise
