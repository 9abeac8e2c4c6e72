#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "common/io/log/session_log_read.h"
#include "tests/network/domain.h"
#include "tests/network/program.h"
#include "tests/support/effort.h"

/// A session as it is demonstrated: a server, four designers, an observer and one who comes late,
/// each in a process of its own, over DDS on loopback.
namespace mortise::test {
namespace {

using Json = nlohmann::json;

constexpr char kScenario[] = R"(
name: four blocks
units: mm
policy: report
parts:
  - {name: base, generator: {kind: block, x: 100, y: 100, z: 10}}
  - {name: red, generator: {kind: block, x: 10, y: 10, z: 10}, moving: true,
     pose: {position: [-20, 0, 20]}, tolerance: {plus_minus: 0.05}}
  - {name: blue, generator: {kind: block, x: 10, y: 10, z: 10}, moving: true,
     pose: {position: [20, 0, 20]}}
  - {name: green, generator: {kind: block, x: 10, y: 10, z: 10}, moving: true,
     pose: {position: [0, 30, 20]}}
  - {name: pin, generator: {kind: dowel, diameter: 6, length: 20}, moving: true,
     pose: {position: [0, -30, 30]}}
)";

/// Red sinks into the base, comes out and ends 0.02 mm above it; blue stays in the base; green and
/// pin meet in the air and part again.
constexpr char kPlay[] = R"(
acts:
  - user: anna
    part: red
    steps:
      - {by: [0, 0, -12], seconds: 1}
      - {rotate_deg: [0, 0, 30], seconds: 0.5}
      - {by: [0, 0, 2.02], seconds: 0.8}
  - {user: ben, part: blue, steps: [{by: [0, 0, -11], seconds: 1.5}, {by: [3, 0, 0], seconds: 0.5}]}
  - user: carla
    part: green
    steps: [{by: [0, -30, 10], seconds: 1}, {seconds: 1}, {by: [0, 20, 0], seconds: 0.5}]
  - {user: dora, part: pin, steps: [{by: [0, 28, 0], seconds: 1.2}, {seconds: 1}]}
)";

Json json_of(const std::string& text) {
  Json json = Json::parse(text, nullptr, false);
  EXPECT_FALSE(json.is_discarded()) << text;
  return json;
}

TEST(DemoSession, AllParticipantsSeeTheSameAndTheLogPlaysAgain) {
  TestFolder folder;
  const std::string domain = std::to_string(own_domain());
  const std::string scenario = folder.write("blocks.yaml", kScenario);
  const std::string play = folder.write("blocks.play.yaml", kPlay);
  const std::string log = (folder.path() / "blocks.mcap").string();

  Program server(folder.path(), "mortise-server",
                 {scenario, "--domain", domain, "--session", "demo", "--log", log, "--duration",
                  "9.5", "--threads", "2", "--json", "--live"});
  const auto participant = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(),
                     {"--domain", domain, "--session", "demo", "--wait", "10", "--json"});
    return std::make_unique<Program>(folder.path(), "mortise-bot", arguments);
  };
  auto observer = participant({"--observer", "--duration", "6.5"});
  std::vector<std::unique_ptr<Program>> designers;
  for (const char* name : {"anna", "ben", "carla", "dora"}) {
    designers.push_back(participant({"--behaviour", "script", "--play", play, "--names", name,
                                     "--delay", "1.5", "--linger", "2"}));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(3200));  // the blocks are on their way
  auto late = participant({"--observer", "--names", "eve", "--duration", "3"});

  for (auto& designer : designers) ASSERT_EQ(designer->wait(kPatience_s), 0) << designer->errors();
  ASSERT_EQ(observer->wait(kPatience_s), 0) << observer->errors();
  ASSERT_EQ(late->wait(kPatience_s), 0) << late->errors();
  ASSERT_EQ(server.wait(kPatience_s), 0) << server.errors();

  // 1. All who were there from the start saw the same events; all know the same poses and clashes.
  const Json seen = json_of(observer->out());
  const Json closing = json_of(server.out());
  EXPECT_GE(seen["events"]["count"].get<int>(), 5) << seen.dump(1);
  EXPECT_EQ(seen["events"]["first_seq"], 1);
  EXPECT_EQ(seen["state"]["open_clashes"].size(), 2U) << seen["state"].dump(1);
  std::set<std::string> classes;
  for (const Json& clash : seen["state"]["open_clashes"]) classes.insert(clash["class"]);
  EXPECT_EQ(classes, (std::set<std::string>{"potential", "real"}));
  std::uint64_t sent = 0;
  for (auto& designer : designers) {
    const Json own = json_of(designer->out());
    EXPECT_EQ(own["events"], seen["events"]) << own["names"];
    EXPECT_EQ(own["state"], seen["state"]) << own["names"];
    EXPECT_EQ(own["troubles"].size(), 0U) << own["troubles"];
    EXPECT_TRUE(own["refused"].empty()) << own["refused"];
    // One an acknowledgement: a tick takes several increments where the machine stood still.
    EXPECT_GT(4 * own["latency_ms"]["count"].get<std::uint64_t>(),
              own["sent"].get<std::uint64_t>());
    EXPECT_GT(own["sent"].get<int>(), 50);
    if (timed()) {
      EXPECT_LT(own["latency_ms"]["p50"].get<double>(), 100.0);
    }
    sent += own["sent"].get<std::uint64_t>();
  }
  EXPECT_EQ(json_of(late->out())["state"], seen["state"]);

  // 2. The server's books agree with theirs.
  EXPECT_EQ(closing["inbox"]["accepted"].get<std::uint64_t>(), sent);
  EXPECT_EQ(closing["inbox"]["leaves"], 6);
  const Json& by_class = closing["statistics"]["by_class"];
  for (const char* name : {"real", "potential", "fake"}) {
    EXPECT_EQ(by_class[name]["total"], seen["clashes_seen"][name]) << name;
  }
  EXPECT_EQ(by_class["real"]["open"], 1);
  EXPECT_GE(by_class["real"]["total"].get<int>(), 3);
  EXPECT_NE(server.errors().find("users"), std::string::npos) << "the live line is missing";

  // 3. The poses are those that the play asks for: the policy lets everything pass.
  const Json& poses = seen["state"]["poses"];
  EXPECT_NEAR(poses["red"][2].get<double>(), 10.02, 1e-9);
  EXPECT_NEAR(poses["blue"][0].get<double>(), 23.0, 1e-9);
  EXPECT_NEAR(poses["pin"][1].get<double>(), -2.0, 1e-9);

  // 4. The log holds every tick, and the same session can be computed from it again.
  const auto read = read_session_log(log);
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_TRUE(read->complete);
  EXPECT_EQ(read->ticks.size(), closing["statistics"]["ticks"].get<std::size_t>());
  EXPECT_NE(read->scenario_yaml.find("four blocks"), std::string::npos);
  // Its ticks had work for two threads, and one decides the same.
  EXPECT_NE(read->scenario_yaml.find("threads: 2"), std::string::npos);
  if (std::filesystem::exists(program_path("mortise-replay"))) {
    Program replay(folder.path(), "mortise-replay", {"verify", log});
    EXPECT_EQ(replay.wait(kPatience_s), 0) << replay.out() << replay.errors();
  }
}

// The demo itself, with a process a designer: 18 parts, three kinds of fits, policy stop.
TEST(DemoSession, TheGearboxIsTheSameForAll) {
  TestFolder folder;
  const std::string domain = std::to_string(own_domain());
  const std::filesystem::path scenarios = std::filesystem::path(MORTISE_SOURCE_DIR) / "scenarios";
  const std::string log = (folder.path() / "gearbox.mcap").string();
  Program server(folder.path(), "mortise-server",
                 {(scenarios / "gearbox.yaml").string(), "--domain", domain, "--session", "demo",
                  "--log", log, "--json"});
  const auto participant = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(),
                     {"--domain", domain, "--session", "demo", "--wait", "10", "--json"});
    return std::make_unique<Program>(folder.path(), "mortise-bot", arguments);
  };
  auto observer = participant({"--observer", "--duration", "34"});
  std::vector<std::unique_ptr<Program>> designers;
  for (const char* name : {"ann", "bob", "cid", "dee"}) {
    designers.push_back(
        participant({"--behaviour", "script", "--play", (scenarios / "gearbox.play.yaml").string(),
                     "--names", name, "--delay", "1.5", "--linger", "12"}));
  }
  std::this_thread::sleep_for(std::chrono::seconds(15));
  auto late = participant({"--observer", "--names", "eve", "--duration", "19"});

  for (auto& designer : designers) ASSERT_EQ(designer->wait(kPatience_s), 0) << designer->errors();
  ASSERT_EQ(observer->wait(kPatience_s), 0) << observer->errors();
  ASSERT_EQ(late->wait(kPatience_s), 0) << late->errors();
  server.signal(SIGTERM);
  ASSERT_EQ(server.wait(kPatience_s), 0) << server.errors();

  const Json seen = json_of(observer->out());
  EXPECT_EQ(seen["events"]["first_seq"], 1);
  for (auto& designer : designers) EXPECT_EQ(json_of(designer->out())["events"], seen["events"]);
  for (const char* name : {"real", "potential", "fake"})
    EXPECT_GE(seen["clashes_seen"][name].get<int>(), 2)
        << name << seen["clashes_seen"].dump(1) << server.out();
  EXPECT_EQ(json_of(late->out())["state"], seen["state"]);
  // The press fit stands at the mouth of its seat, the free bearing is home.
  const Json& poses = seen["state"]["poses"];
  EXPECT_GT(poses["bearing_out_upper"][2].get<double>(),
            poses["bearing_in_upper"][2].get<double>() + 1.0);
  for (const char* threads : {"1", "2"}) {
    Program replay(folder.path(), "mortise-replay", {"verify", log, "--threads", threads});
    EXPECT_EQ(replay.wait(kPatience_s), 0) << threads << replay.out() << replay.errors();
  }
}

}  // namespace
}  // namespace mortise::test
