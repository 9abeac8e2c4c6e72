// The bot as a program that a pipeline runs, and what the server says for machines to read.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "common/evaluation/clash_line.h"
#include "tests/network/domain.h"
#include "tests/network/program.h"
#include "tests/network/same_everywhere.h"
#include "tests/support/small_scenarios.h"

namespace mortise::test {
namespace {

using Json = nlohmann::json;

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST(BotProgram, ALimitThatDoesNotHoldIsExitCode5AndAFailureForJUnit) {
  TestFolder folder;
  const std::string domain = std::to_string(own_domain());
  Program server(folder.path(), "mortise-server",
                 {folder.write("blocks.yaml", blocks_yaml()), "--domain", domain, "--no-log"});
  const std::string junit = (folder.path() / "bots.xml").string();
  Program bots(folder.path(), "mortise-bot",
               {"--domain",        domain,    "--wait",       "20",      "--users",    "2",
                "--processes",     "2",       "--ramp",       "1",       "--duration", "4",
                "--behaviour",     "wander",  "--json",       "--junit", junit,        "--limit",
                "p99_ms=0.000001", "--limit", "lost_events=0"});
  ASSERT_EQ(bots.wait(kPatience_s), 5) << bots.errors();
  EXPECT_NE(bots.errors().find("p99_ms"), std::string::npos) << bots.errors();
  EXPECT_EQ(bots.errors().find("lost_events:"), std::string::npos) << bots.errors();

  const Json report = Json::parse(bots.out());
  EXPECT_EQ(report["processes"], 2);
  EXPECT_EQ(report["users"], 4);
  EXPECT_GT(report["sent"].get<int>(), 0);
  ASSERT_EQ(report["limits"].size(), 2u);
  EXPECT_EQ(report["limits"][0]["holds"], false);
  EXPECT_EQ(report["limits"][1]["holds"], true);

  const std::string xml = text_of(junit);
  EXPECT_NE(xml.find("tests=\"2\" failures=\"1\""), std::string::npos) << xml;
  const std::size_t failure = xml.find("<failure");
  ASSERT_NE(failure, std::string::npos) << xml;
  EXPECT_LT(xml.find("name=\"p99_ms\""), failure) << xml;
  EXPECT_EQ(xml.find("<failure", failure + 1), std::string::npos) << "the other holds: " << xml;
}

// Its report against what others know of the same session, and the server's own counts.
TEST(BotProgram, WhatItReportsIsWhatHappened) {
  TestFolder folder;
  const std::string domain = std::to_string(own_domain());
  const std::string log = (folder.path() / "bots.mcap").string();
  Program server(
      folder.path(), "mortise-server",
      {folder.write("blocks.yaml", blocks_yaml()), "--domain", domain, "--log", log, "--json"});
  Guest anna(own_domain(), "anna", "observer"), ben(own_domain(), "ben", "observer");
  ASSERT_TRUE(anna.joined()) << server.errors();
  ASSERT_TRUE(ben.joined());
  Program bots(folder.path(), "mortise-bot",
               {"--domain", domain, "--wait", "20", "--users", "3", "--behaviour", "mixed",
                "--duration", "5", "--linger", "3", "--json"});
  ASSERT_TRUE(anna.until(kPatience_s, [&] {
    ben.listen();
    return !bots.running();
  }));
  ASSERT_EQ(bots.wait(0.1), 0) << bots.errors();
  const Json report = Json::parse(bots.out());
  const Knowledge known = agreed_by({&anna, &ben});
  server.signal(SIGTERM);
  ASSERT_EQ(server.wait(kPatience_s), 0) << server.errors();
  const Json closing = Json::parse(server.out());
  expect_in_log(known, log, {});
  expect_told_at_end(known, closing);

  ASSERT_EQ(report["state"]["poses"].size(), known.parts.size());
  for (const auto& [id, part] : known.parts) {
    const Vec3& p = part.X_WP.p;
    const Quat& q = part.X_WP.q;
    EXPECT_EQ(report["state"]["poses"][part.name],
              Json({p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()}));
  }
  ASSERT_EQ(report["state"]["open_clashes"].size(), known.open.size());
  for (const Json& told : report["state"]["open_clashes"]) {
    const auto clash = known.open.find(ClashId{told["clash"].get<std::uint32_t>()});
    ASSERT_NE(clash, known.open.end()) << told;
    const Interval& delta_mm = clash->second.verdict.delta_mm;
    EXPECT_EQ(told["delta_mm"], Json({delta_mm.lo, delta_mm.hi}));
  }
  std::uint64_t received = 0, refused = 0, said_refused = 0;
  for (const Json& user : closing["users"]) {
    received += user["received"].get<std::uint64_t>();
    refused += user["refused"].get<std::uint64_t>();
  }
  for (const auto& [reason, count] : report["refused"].items())
    said_refused += count.get<std::uint64_t>();
  EXPECT_GT(received, 100u);
  EXPECT_EQ(report["sent"].get<std::uint64_t>(), received);
  EXPECT_EQ(said_refused, refused);
  EXPECT_EQ(report["lost"]["events"], 0);
  EXPECT_EQ(report["unacknowledged_increments"], 0);
  EXPECT_EQ(report["events"]["count"].get<std::uint64_t>(), known.event_seq);
  for (const char* what : {"latency_ms", "event_latency_ms"}) {
    const Json& ms = report[what];
    EXPECT_GT(ms["p50"].get<double>(), 0.0) << ms;
    EXPECT_LE(ms["p50"].get<double>(), ms["p99"].get<double>()) << ms;
    EXPECT_LE(ms["p99"].get<double>(), ms["max"].get<double>()) << ms;
  }
}

TEST(BotProgram, AReportThatCannotBeWrittenIsNoSuccess) {
  TestFolder folder;
  const std::string domain = std::to_string(own_domain());
  Program server(folder.path(), "mortise-server",
                 {folder.write("blocks.yaml", blocks_yaml()), "--domain", domain, "--no-log"});
  Program bots(folder.path(), "mortise-bot",
               {"--domain", domain, "--wait", "20", "--duration", "1", "--behaviour", "wander",
                "--junit", "/proc/none/bots.xml", "--limit", "lost_events=0"});
  EXPECT_EQ(bots.wait(kPatience_s), 1);
  EXPECT_NE(bots.errors().find("/proc/none/bots.xml"), std::string::npos) << bots.errors();
}

constexpr char kPressed[] = R"(
acts:
  - user: anna
    part: red
    steps: [{by: [0, 0, -12], seconds: 0.4}, {by: [0, 0, 12], seconds: 0.4}, {by: [0, 0, -12], seconds: 0.4}]
)";

// red is pressed into the base, and nothing touches blue.
TEST(BotProgram, HoldsTheWorstClassThatIsToldOfTwoParts) {
  TestFolder folder;
  const std::string domain = std::to_string(own_domain());
  Program server(folder.path(), "mortise-server",
                 {folder.write("blocks.yaml", blocks_yaml()), "--domain", domain, "--no-log"});
  const auto exit_code = [&](std::vector<std::string> arguments, std::string& said) {
    arguments.insert(arguments.end(), {"--domain", domain, "--wait", "20"});
    Program bot(folder.path(), "mortise-bot", arguments);
    const int code = bot.wait(kPatience_s);
    said = bot.errors();
    return code;
  };
  std::string said;
  EXPECT_EQ(
      exit_code({"--behaviour", "script", "--play", folder.write("play.yaml", kPressed), "--limit",
                 "expect_clash red,base=real", "--limit", "expect_clash red,blue=none"},
                said),
      0)
      << said;
  // The second one was not there when it happened, and knows what is open.
  EXPECT_EQ(
      exit_code({"--observer", "--duration", "1", "--limit", "expect_clash base,red=potential",
                 "--limit", "expect_clash base,blue=none", "--limit", "expect_clash blue,red=real"},
                said),
      5);
  EXPECT_NE(said.find("base, red: real is told, potential expected"), std::string::npos) << said;
  EXPECT_NE(said.find("blue, red: none is told, real expected"), std::string::npos) << said;
  EXPECT_EQ(said.find("base, blue"), std::string::npos) << "this one holds: " << said;
}

// What people read while it runs: a line for who comes and goes and for each clash, its class
// first.
TEST(ServerMessages, OfALiveRunAreAKnownFewAndNoneIsTooWide) {
  TestFolder folder;
  const std::string domain = std::to_string(own_domain()), wide = " red_" + std::string(60, 'w');
  std::string yaml = blocks_yaml(), play = kPressed;
  yaml.replace(yaml.find(" red,"), 4, wide);
  play.replace(play.find(" red\n"), 4, wide);
  Program server(folder.path(), "mortise-server",
                 {folder.write("blocks.yaml", yaml), "--domain", domain, "--log",
                  (folder.path() / "live.mcap").string(), "--live", "--json"});
  Program bot(folder.path(), "mortise-bot",
              {"--domain", domain, "--wait", "20", "--behaviour", "script", "--play",
               folder.write("play.yaml", play), "--linger", "0.5"});
  ASSERT_EQ(bot.wait(kPatience_s), 0) << bot.errors();
  server.signal(SIGTERM);
  ASSERT_EQ(server.wait(kPatience_s), 0) << server.errors();

  const std::string pair = "base × red_w+…w+ +", clash = "clash [0-9]+";
  const std::vector<std::pair<std::string, std::regex>> known = {
      {"session", std::regex("session 'default' of .*: 3 parts, 60 Hz, policy report, domain .*")},
      {"log", std::regex("log .*live.mcap")},
      {"people", std::regex("anna (joined|left)")},
      {"begin", std::regex("REAL  " + pair + "[0-9.]+ [µm]+ deep +" + clash + " by anna")},
      {"end", std::regex("ENDED  " + pair + "was real for [0-9.]+ s +" + clash)},
      {"live", std::regex("[0-9.]+ s, [01] users? \\| open: [0-9]+ real, 0 potential, 0 fake \\| "
                          "tick p99 [0-9.]+ ms( \\| [0-9]+ deadlines missed)?")},
      {"overload", std::regex("warning: overload: .*")}};  // of a busy machine
  std::set<std::string> seen;
  std::istringstream lines(server.errors());
  for (std::string line; std::getline(lines, line);) {
    ASSERT_GT(line.size(), 9u) << server.errors();
    const std::string message = line.substr(9);  // behind the time of day
    const auto is = std::find_if(known.begin(), known.end(), [&](const auto& kind) {
      return std::regex_match(message, kind.second);
    });
    ASSERT_NE(is, known.end()) << "nobody asked for: " << line << "\n" << server.errors();
    seen.insert(is->first);
    if (is->first == "session" || is->first == "log") continue;  // these name files
    EXPECT_LE(columns_of(message), kClashLineColumns) << message;
  }
  for (const char* kind : {"session", "log", "people", "begin", "end", "live"})
    EXPECT_TRUE(seen.contains(kind)) << kind << "\n" << server.errors();
}

TEST(ServerMessages, EachLineIsAnObject) {
  TestFolder folder;
  const std::string domain = std::to_string(own_domain());
  Program server(folder.path(), "mortise-server",
                 {folder.write("blocks.yaml", blocks_yaml()), "--domain", domain, "--no-log",
                  "--messages", "json"});
  const std::string name = "an\"na \\ \xc3\xa4";
  {
    Guest anna(own_domain(), name);
    ASSERT_TRUE(anna.joined()) << server.errors();
    anna.client->leave(anna.user);
    anna.until(0.5, [] { return false; });
  }
  server.signal(SIGTERM);
  ASSERT_EQ(server.wait(kPatience_s), 0) << server.errors();
  std::istringstream lines(server.errors());
  std::set<std::string> messages;
  for (std::string line; std::getline(lines, line);) {
    const Json json = Json::parse(line, nullptr, false);
    ASSERT_TRUE(json.is_object()) << line;
    ASSERT_EQ(json.size(), 4u) << line;
    for (const char* key : {"time", "level", "program", "message"})
      ASSERT_TRUE(json[key].is_string()) << line;
    const auto time = json["time"].get<std::string>();
    EXPECT_TRUE(time.size() == 24 && time[10] == 'T' && time.ends_with("Z")) << line;
    messages.insert(json["message"].get<std::string>());
  }
  EXPECT_TRUE(messages.contains(name + " joined")) << server.errors();
  EXPECT_TRUE(messages.contains(name + " left")) << server.errors();
}

}  // namespace
}  // namespace mortise::test
