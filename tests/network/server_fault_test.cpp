#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "client/client.h"
#include "common/io/log/session_log_read.h"
#include "idl/dds_channel.h"
#include "tests/network/domain.h"
#include "tests/network/program.h"
#include "tests/network/same_everywhere.h"
#include "tests/support/effort.h"
#include "tests/support/small_scenarios.h"

/// The real server under bad luck and bad company, over DDS on loopback.
namespace mortise::test {
namespace {

using Json = nlohmann::json;

const Blocks kBlocks{"lease_s: 1\n", "[0, 0, 60]", "[500, 0, 20]"};

class ServerFault : public ::testing::Test {
 protected:
  std::unique_ptr<Program> serve(std::vector<std::string> arguments = {"--no-log"}) {
    const std::string scenario = folder_.write("blocks.yaml", blocks_yaml(kBlocks));
    arguments.insert(arguments.begin(), {scenario, "--domain", std::to_string(domain_), "--json"});
    return std::make_unique<Program>(folder_.path(), "mortise-server", arguments);
  }
  static std::size_t lines(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  }
  const int domain_ = own_domain();
  TestFolder folder_;
};

TEST_F(ServerFault, AKilledDesignerLosesItsPartSoonAndTheSessionGoesOn) {
  const std::string log = (folder_.path() / "killed.mcap").string();
  auto server = serve({"--log", log, "--policy", "report"});
  Program bot(folder_.path(), "mortise-bot",
              {"--domain", std::to_string(domain_), "--wait", "10", "--part", "red", "--behaviour",
               "wander"});
  Guest ben(domain_, "ben"), cid(domain_, "cid");  // who joins late
  ASSERT_TRUE(ben.joined()) << server->errors();
  ASSERT_TRUE(
      ben.until(kPatience_s, [&] { return bool(ben.holder("red")) && ben.x("red") != 0.0; }));
  EXPECT_FALSE(ben.grab("red")) << "it is in other hands";
  ASSERT_FALSE(ben.replies.empty());
  EXPECT_EQ(ben.replies.back().refusal, Refusal::kHeldByOther);
  EXPECT_NE(ben.replies.back().text.find("bot1-1"), std::string::npos) << ben.replies.back().text;

  bot.signal(SIGKILL);
  const double killed_s = steady_s();
  ASSERT_TRUE(ben.until(kPatience_s, [&] { return !ben.holder("red"); }));
  if (timed()) {  // liveliness lease 0.8 s; its check, a tick and the way back
    EXPECT_LT(steady_s() - killed_s, 2.0);
  }
  EXPECT_TRUE(ben.grab("red"));
  const PartId red = ben.client->find_part("red");
  std::uint64_t last = 0;
  // To where it clashes with the base, wherever the bot had it.
  const Vec3 there = Vec3(0, 0, 9) - ben.client->parts().at(red).info.X_WP.p;
  for (int i = 0; i < 20; ++i) last = ben.client->send(ben.user, red, there / 20.0);
  EXPECT_TRUE(ben.until(kPatience_s, [&] { return ben.taken.contains(last); }));
  ASSERT_TRUE(cid.until(kPatience_s, [&] {
    ben.listen();
    return cid.client->user_id(cid.user) && cid.client->synced();
  }));
  const Knowledge known = agreed_by({&ben, &cid});
  EXPECT_GE(known.open.size(), 1u) << "nothing to agree on";
  server->signal(SIGTERM);
  EXPECT_EQ(server->wait(kPatience_s), 0);
  const Json closing = Json::parse(server->out());
  EXPECT_EQ(closing["inbox"]["liveliness_lost"], 1);
  expect_told_at_end(known, closing);
  expect_in_log(known, log, {&ben});
  expect_nothing_lost(ben, "ben", closing);
}

TEST_F(ServerFault, NonsenseIsRefusedWithAReasonCountedAndTheSessionGoesOn) {
  const std::string log = (folder_.path() / "nonsense.mcap").string();
  auto server = serve({"--log", log});
  Guest anna(domain_, "anna"), ben(domain_, "ben");
  ASSERT_TRUE(anna.joined()) << server->errors();
  ASSERT_TRUE(ben.joined());
  ASSERT_TRUE(anna.grab("red"));
  ASSERT_TRUE(ben.grab("blue"));
  const UserId id = anna.client->user_id(anna.user);
  const PartId red = anna.client->find_part("red"), blue = anna.client->find_part("blue");
  const double nan = std::numeric_limits<double>::quiet_NaN();

  anna.client->send(anna.user, red, {1, 0, 0});             // seq 1, good
  anna.client->send(anna.user, red, {nan, 0, 0});           // 2 not finite
  anna.client->send(anna.user, red, {1e12, 0, 0});          // 3 huge
  anna.client->send(anna.user, red, {0, 0, 0}, {0, 0, 4});  // 4 turns too far
  anna.client->send(anna.user, blue, {1, 0, 0});            // 5 foreign part
  anna.client->send(anna.user, PartId{99}, {1, 0, 0});      // 6 no such part
  anna.client->send(anna.user, red, {1, 0, 0});             // 7 good
  anna.channel->send(batch_of(Increment{id, red, 7, {9, 0, 0}, Vec3::Zero()}, 0));   // replayed
  anna.channel->send(batch_of(Increment{id, red, 20, {1, 0, 0}, Vec3::Zero()}, 0));  // 20 good
  anna.channel->send(batch_of(Increment{id, red, 15, {9, 0, 0}, Vec3::Zero()}, 0));  // out of order
  ben.channel->send(
      batch_of(Increment{id, red, 1000, {9, 0, 0}, Vec3::Zero()}, 0));  // foreign user
  EXPECT_TRUE(
      anna.until(kPatience_s, [&] { return anna.refused.size() >= 7 && anna.x("red") == 3.0; }));
  anna.channel->send(batch_of(Increment{id, red, 21, {1, 0, 0}, Vec3::Zero()}, 0));
  EXPECT_TRUE(anna.until(kPatience_s, [&] { return anna.x("red") == 4.0; }))
      << "the session goes on";

  std::map<Refusal, int> reasons;
  for (const RefusedIncrement& r : anna.refused) ++reasons[r.reason];
  const std::map<Refusal, int> expected = {
      {Refusal::kNotFinite, 1}, {Refusal::kJumpTooLarge, 1}, {Refusal::kRotationTooLarge, 1},
      {Refusal::kNotHolder, 1}, {Refusal::kUnknownPart, 1},  {Refusal::kDuplicate, 1},
      {Refusal::kStale, 1}};
  EXPECT_EQ(reasons, expected);
  EXPECT_TRUE(ben.until(kPatience_s, [&] { return ben.refused.size() == 1; }))
      << "told to who sent it";
  const Knowledge known = agreed_by({&anna, &ben});
  server->signal(SIGINT);
  EXPECT_EQ(server->wait(kPatience_s), 0);
  expect_told_at_end(known, Json::parse(server->out()));
  expect_in_log(known, log, {&anna, &ben});
  const Json inbox = Json::parse(server->out())["inbox"];
  EXPECT_EQ(inbox["accepted"], 4);
  EXPECT_EQ(inbox["foreign"], 1);
  int counted = 0;
  for (const auto& [reason, count] : inbox["refused"].items()) counted += count.get<int>();
  EXPECT_EQ(counted, 8) << inbox.dump(1);
}

TEST_F(ServerFault, ASilentHandLosesTheLease) {
  auto server = serve();
  Guest anna(domain_, "anna"), ben(domain_, "ben");
  ASSERT_TRUE(anna.joined()) << server->errors();
  ASSERT_TRUE(ben.joined());
  ASSERT_TRUE(anna.grab("red"));
  // Heartbeats alone keep it.
  EXPECT_FALSE(anna.until(1.6, [&] {
    ben.client->poll();
    return !anna.holder("red");
  }));
  // Without them it is free after the lease of 1 s (or liveliness, 0.8 s), and anna is told later.
  ASSERT_TRUE(ben.until(kPatience_s, [&] { return !ben.holder("red"); }));
  EXPECT_TRUE(ben.grab("red"));
}

TEST_F(ServerFault, ATermSignalEndsInOrder) {
  const std::string log = (folder_.path() / "term.mcap").string();
  auto server = serve({"--log", log, "--policy", "report"});
  Guest anna(domain_, "anna");
  ASSERT_TRUE(anna.joined()) << server->errors();
  ASSERT_TRUE(anna.grab("red"));
  anna.client->send(anna.user, anna.client->find_part("red"), {1, 0, 0});
  ASSERT_TRUE(anna.until(kPatience_s, [&] { return anna.x("red") == 1.0; }));
  EXPECT_EQ(anna.client->policy(), "report");
  server->signal(SIGTERM);
  ASSERT_EQ(server->wait(kPatience_s), 0);
  const auto read = read_session_log(log);
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_TRUE(read->complete);
  EXPECT_NE(read->scenario_yaml.find("policy: report"), std::string::npos)
      << "the log must hold the scenario as it was played";
  EXPECT_EQ(Json::parse(server->out())["policy"], "report");
}

TEST_F(ServerFault, WhatCannotStartSaysSoInOneLine) {
  const std::string scenario = folder_.write("blocks.yaml", blocks_yaml(kBlocks));
  const std::string elsewhere = std::to_string(take_domains(1));
  auto first = serve();
  Guest anna(domain_, "anna");
  ASSERT_TRUE(anna.joined()) << first->errors();
  const struct {
    std::vector<std::string> arguments;
    int code;
    const char* says;
  } cases[] = {
      {{scenario, "--domain", std::to_string(domain_), "--no-log"}, 1, "in use"},
      {{scenario, "--domain", elsewhere, "--log", "/proc/none/x.mcap"}, 1, "/proc/none"},
      {{folder_.write("bad.yaml", "name: x\nunits: mm\nparts: 3\n"), "--domain", elsewhere},
       3,
       "parts"},
      {{(folder_.path() / "missing.yaml").string(), "--domain", elsewhere}, 3, "missing.yaml"},
  };
  for (const auto& [arguments, code, says] : cases) {
    Program server(folder_.path(), "mortise-server", arguments);
    EXPECT_EQ(server.wait(kPatience_s), code) << arguments.back();
    EXPECT_NE(server.errors().find(says), std::string::npos) << server.errors();
    EXPECT_LE(lines(server.errors()), code == 3 ? 3U : 1U) << server.errors();
  }
  Program bot(folder_.path(), "mortise-bot", {"--domain", elsewhere, "--wait", "0.5"});
  EXPECT_EQ(bot.wait(kPatience_s), 1);
  EXPECT_EQ(lines(bot.errors()), 1U) << bot.errors();
  Program script(folder_.path(), "mortise-bot",
                 {"--behaviour", "script", "--play", folder_.write("p.yaml", "acts: 3\n")});
  EXPECT_EQ(script.wait(kPatience_s), 3);
}

TEST_F(ServerFault, AnIdleSessionCostsNextToNothing) {
  auto server = serve();
  Guest anna(domain_, "anna");
  ASSERT_TRUE(anna.joined()) << server->errors();
  anna.until(0.5, [] { return false; });
  const double start_s = steady_s(), cpu_start_s = server->cpu_s();
  anna.until(timed() ? 4.0 : 1.0, [] { return false; });
  const double share = (server->cpu_s() - cpu_start_s) / (steady_s() - start_s);
  std::printf("idle server at 60 Hz with one participant: %.2f %% of one core\n", share * 100);
  if (timed()) {
    EXPECT_LE(share, 0.03);
  }
  server->signal(SIGTERM);
  ASSERT_EQ(server->wait(kPatience_s), 0);
  const Json stages = Json::parse(server->out())["statistics"]["stages"];
  EXPECT_EQ(stages["queries"]["first_contact"], 0);
  EXPECT_EQ(stages["queries"]["depth"], 0);
}

}  // namespace
}  // namespace mortise::test
