// The bot as a program that a pipeline runs, and what the server says for machines to read.
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

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
