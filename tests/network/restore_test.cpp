#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/io/log/log_chain.h"
#include "common/io/log/session_log.h"
#include "tests/network/domain.h"
#include "tests/network/program.h"
#include "tests/network/same_everywhere.h"
#include "tests/support/effort.h"
#include "tests/support/small_scenarios.h"

/// The server killed without warning and started again on its own log; and a disk that is full.
namespace mortise::test {
namespace {

using Json = nlohmann::json;

class RestoreAfterCrash : public ::testing::Test {
 protected:
  std::unique_ptr<Program> serve(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--domain", std::to_string(domain_), "--json"});
    return std::make_unique<Program>(folder_.path(), "mortise-server", arguments);
  }
  std::string scenario() const { return folder_.write("blocks.yaml", blocks_yaml()); }
  std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  static bool step_by(Guest& guest, const char* part, const Vec3& by_mm) {
    const PartId id = guest.client->find_part(part);
    const Vec3 to = guest.client->parts().at(id).info.X_WP.p + by_mm;
    guest.client->send(guest.user, id, by_mm);
    return guest.until(
        3, [&] { return (guest.client->parts().at(id).info.X_WP.p - to).norm() < 1e-9; });
  }
  static std::map<PartId, Pose> poses(const Guest& guest) {
    std::map<PartId, Pose> poses;
    for (const auto& [id, part] : guest.client->parts()) poses[id] = part.info.X_WP;
    return poses;
  }
  static void kill_and_wait(Program& server) {
    server.signal(SIGKILL);
    ASSERT_EQ(server.wait(kPatience_s), 128 + SIGKILL);
  }

  const int domain_ = own_domain();
  TestFolder folder_;
};

/// A session that a program of 0.2.0 has played goes on here, with one that stands by, and there.
TEST_F(RestoreAfterCrash, ALogOfAVersionBeforeGoesOnAndIsFollowed) {
  const std::string logs = file("logs");
  std::filesystem::create_directories(logs);
  std::filesystem::copy(MORTISE_SOURCE_DIR "/tests/golden/before/0.2.0/moves.mcap",
                        logs + "/default-20261127-120000.mcap");
  auto first = serve({"--restore", logs, "--log", logs});
  Guest anna(domain_, "anna");
  ASSERT_TRUE(anna.joined()) << first->errors();
  EXPECT_EQ(anna.client->user_id(anna.user), UserId{1}) << "she is who she was";
  EXPECT_EQ(anna.x("red"), 8.0);
  EXPECT_EQ(anna.x("blue"), 32.0);
  auto second = serve({"--standby-of", "default", "--restore", logs, "--log", logs});
  ASSERT_TRUE(anna.until(kPatience_s, [&] {
    return second->errors().find("in step") != std::string::npos || !second->running();
  }));
  ASSERT_TRUE(second->running()) << second->errors();
  const auto moves_to = [&](double x) {
    anna.client->send(anna.user, anna.client->find_part("red"), {0.5, 0, 0});
    return anna.until(kPatience_s, [&] { return anna.x("red") == x; });
  };
  ASSERT_TRUE(anna.grab("red"));
  ASSERT_TRUE(moves_to(8.5)) << first->errors();
  kill_and_wait(*first);
  ASSERT_TRUE(anna.until(kPatience_s, [&] {
    return anna.client->statistics().server_losses > 0 && anna.client->user_id(anna.user) &&
           anna.client->synced();
  })) << second->errors();
  EXPECT_EQ(anna.client->user_id(anna.user), UserId{1});
  EXPECT_EQ(anna.x("red"), 8.5);
  ASSERT_TRUE(anna.grab("red")) << "a busy machine may have taken it";
  EXPECT_TRUE(moves_to(9.0)) << second->errors();
  second->signal(SIGTERM);
  EXPECT_EQ(second->wait(kPatience_s), 0) << second->errors();
}

TEST_F(RestoreAfterCrash, PosesClashesNumbersAndUndoAreWhatTheyWere) {
  auto server = serve({scenario(), "--log", file("first.mcap")});
  Guest anna(domain_, "anna"), ben(domain_, "ben");
  ASSERT_TRUE(anna.joined()) << server->errors();
  ASSERT_TRUE(ben.joined());
  const UserId anna_id = anna.client->user_id(anna.user);
  ASSERT_TRUE(anna.grab("red"));
  ASSERT_TRUE(ben.grab("blue"));
  ASSERT_TRUE(step_by(anna, "red", {1, 0, -12}));   // 2 mm into the base
  ASSERT_TRUE(step_by(ben, "blue", {0, 1, -11}));   // 1 mm
  ASSERT_TRUE(step_by(ben, "blue", {0, 0.25, 4}));  // and out again: that clash has ended
  ASSERT_TRUE(anna.until(kPatience_s, [&] { return anna.client->open_clashes().size() == 1; }));
  anna.until(2.2, [&] {  // two flushes later all of it is on disk
    ben.listen();
    return false;
  });
  const auto poses_before = poses(anna);
  const std::map<ClashId, ClashEvent> open_before = anna.client->open_clashes();
  const std::uint64_t events_before = anna.client->statistics().highest_event_seq;
  ASSERT_EQ(open_before.size(), 1U);
  ASSERT_GE(events_before, 3U);
  kill_and_wait(*server);
  const auto log = read_session_log(file("first.mcap"));
  ASSERT_TRUE(log) << log.error().text;
  EXPECT_FALSE(log->complete);

  const double restarted_s = steady_s();
  server = serve({"--restore", file("first.mcap"), "--log", file("second.mcap")});
  ASSERT_TRUE(anna.until(kPatience_s, [&] {
    ben.listen();
    return anna.client->statistics().server_losses > 0 && anna.client->user_id(anna.user) &&
           anna.client->synced();
  })) << server->errors();
  std::printf("back in the session %.2f s after the new process started\n",
              steady_s() - restarted_s);
  EXPECT_EQ(anna.client->user_id(anna.user), anna_id) << "the same user by name";
  ASSERT_EQ(poses(anna).size(), poses_before.size());
  for (const auto& [id, pose] : poses_before) EXPECT_TRUE(identical(poses(anna)[id], pose));
  ASSERT_EQ(anna.client->open_clashes().size(), 1U);
  const auto& [id, clash] = *anna.client->open_clashes().begin();
  const ClashEvent& before = open_before.begin()->second;
  EXPECT_EQ(id, open_before.begin()->first);
  EXPECT_EQ(clash.verdict.delta_mm, before.verdict.delta_mm);
  EXPECT_EQ(clash.verdict.collision_class, before.verdict.collision_class);
  EXPECT_EQ(clash.begin_tick, before.begin_tick);
  EXPECT_EQ(clash.seq, before.seq);
  EXPECT_FALSE(anna.holder("red")) << "held parts are free";
  EXPECT_FALSE(anna.holder("blue"));

  // Numbers go on; what was moved before the crash can be undone after it.
  ASSERT_TRUE(anna.until(kPatience_s, [&] { return anna.client->find_part("red") != PartId{}; }));
  anna.client->undo(anna.user, anna.client->find_part("red"));
  // Poses and events travel apart: either may be first.
  ASSERT_TRUE(anna.until(kPatience_s, [&] {
    return anna.client->open_clashes().empty() && anna.x("red") == 0.0;
  })) << anna.x("red");
  EXPECT_EQ(anna.client->statistics().highest_event_seq, events_before + 1);
  anna.until(0.3, [] { return false; });
  const Knowledge known = agreed_by({&anna, &ben});
  server->signal(SIGTERM);
  ASSERT_EQ(server->wait(kPatience_s), 0) << server->errors();
  const Json closing = Json::parse(server->out());
  expect_told_at_end(known, closing);
  expect_in_log(known, file("first.mcap"), {&anna, &ben});  // and what goes on from it
  EXPECT_EQ(closing["restored"]["ticks"].get<std::size_t>(), log->ticks.size());
  EXPECT_EQ(closing["restored"]["left_out_ticks"], 0);

  // The new log begins with the state at the end of the old one: alone and together they replay.
  const auto second = read_session_log(file("second.mcap"));
  ASSERT_TRUE(second) << second.error().text;
  EXPECT_TRUE(second->complete);
  ASSERT_TRUE(second->begin);
  EXPECT_EQ(second->chain.previous, "first.mcap");
  EXPECT_EQ(second->begin->state.tick, log->ticks.back().tick);
  EXPECT_EQ(second->begin->state.state_hash, log->ticks.back().report.state_hash);
  EXPECT_EQ(second->ticks.front().tick, log->ticks.back().tick + 1);
  for (const char* from : {"first.mcap", "second.mcap"}) {
    Program replay(folder_.path(), "mortise-replay", {"verify", file(from)});
    EXPECT_EQ(replay.wait(kPatience_s), 0) << replay.out() << replay.errors();
  }
}

// In the middle of everything, twice, from a folder: what the log of the dead server tells up to
// its last whole chunk is where the next one begins.
TEST_F(RestoreAfterCrash, InMidMotionTheLastFlushedSecondCounts) {
  const std::filesystem::path logs = folder_.path() / "logs";
  std::filesystem::create_directories(logs);
  const auto newest = [&] {
    std::filesystem::path last;
    for (const auto& entry : std::filesystem::directory_iterator(logs))
      if (entry.path().extension() == ".mcap" && entry.path().filename() > last.filename())
        last = entry.path();
    return last;
  };
  const std::vector<std::string> arguments = {scenario(), "--restore", logs.string(), "--log",
                                              logs.string()};
  Program bots(folder_.path(), "mortise-bot",
               {"--domain", std::to_string(domain_), "--wait", "20", "--users", "3", "--behaviour",
                "mixed", "--duration", "120", "--json"});
  const auto bots_in = [](const Guest& guest) {
    return std::ranges::count_if(guest.client->users(), [](const UserInfo& user) {
      return user.present && user.name.starts_with("bot");
    });
  };
  std::filesystem::path first, before;
  std::uint64_t ticks = 0;
  for (int crash = 0; crash < 3; ++crash) {
    auto server = serve(arguments);
    Guest anna(domain_, "anna" + std::to_string(crash));
    ASSERT_TRUE(anna.joined()) << server->errors();
    ASSERT_TRUE(anna.until(kPatience_s, [&] { return bots_in(anna) == 3; }))
        << "the bots do not come back: " << bots.errors();
    const std::uint64_t seen = anna.client->statistics().highest_tick;
    EXPECT_GE(seen, ticks) << "the session began anew";
    ASSERT_TRUE(anna.until(kPatience_s, [&] {
      return anna.client->statistics().highest_tick > seen + 150;
    })) << server->errors();
    const std::uint64_t killed_at = anna.client->statistics().highest_tick;
    kill_and_wait(*server);
    const std::filesystem::path file = newest();
    ASSERT_NE(file, before) << "each server writes a log of its own";
    if (first.empty()) first = file;
    const auto log = read_session(first);
    ASSERT_TRUE(log) << log.error().text;
    ASSERT_FALSE(log->ticks.empty());
    ticks = log->ticks.back().tick;
    EXPECT_EQ(log->ticks.size(), ticks) << "nothing is missing from the first tick on";
    if (timed()) {  // a flush each second of 60 ticks, and a busy disk
      EXPECT_GT(ticks + 180, killed_at);
    }
    before = file;
  }
  Program replay(folder_.path(), "mortise-replay", {"verify", first.string()});
  EXPECT_EQ(replay.wait(kPatience_s), 0) << replay.out() << replay.errors();

  // And once more, to the end: the bots finish in order, and all know the same.
  auto server = serve(arguments);
  Guest anna(domain_, "anna"), ben(domain_, "ben");
  ASSERT_TRUE(anna.joined()) << server->errors();
  ASSERT_TRUE(ben.joined());
  ASSERT_TRUE(anna.until(kPatience_s, [&] { return bots_in(anna) == 3; })) << bots.errors();
  anna.until(2.5, [&] {  // what was done here is on disk
    ben.listen();
    return false;
  });
  bots.signal(SIGTERM);
  ASSERT_EQ(bots.wait(kPatience_s), 0) << bots.errors();
  const Json told = Json::parse(bots.out());
  EXPECT_EQ(told["server_losses"], 3);
  const Knowledge known = agreed_by({&anna, &ben});
  server->signal(SIGTERM);
  ASSERT_EQ(server->wait(kPatience_s), 0) << server->errors();
  const Json closing = Json::parse(server->out());
  expect_told_at_end(known, closing);
  expect_in_log(known, first, {&anna, &ben});
  std::uint64_t accepted = 0, logged = 0;
  for (const Json& user : closing["users"]) accepted += user["accepted"].get<std::uint64_t>();
  const auto log = read_session_log(newest());
  ASSERT_TRUE(log) << log.error().text;
  for (const TickRecord& tick : log->ticks) logged += tick.increments.size();
  EXPECT_GT(accepted, 0u);
  EXPECT_EQ(logged, accepted) << "what was taken is in the log";
}

TEST_F(RestoreAfterCrash, WhatCannotBeRestoredSaysSoInOneLine) {
  const std::string no_log = folder_.write("none.mcap", "no log");
  const struct {
    std::vector<std::string> arguments;
    int code;
    const char* says;
  } cases[] = {
      {{"--restore", no_log}, 3, "none.mcap"},
      {{"--restore", folder_.path().string(), "--session", "other"}, 3, "no log of session"},
      {{"--restore", no_log, "--policy", "stop"}, 2, "--policy"},
      {{}, 2, "--restore"},
  };
  for (const auto& [arguments, code, says] : cases) {
    auto server = serve(arguments);
    EXPECT_EQ(server->wait(kPatience_s), code);
    EXPECT_NE((server->errors() + server->out()).find(says), std::string::npos)
        << server->errors() << server->out();
  }
}

// The disk is full from some point on: said once, counted, and the session does not notice.
TEST_F(RestoreAfterCrash, AFullDiskIsSaidOnceAndTheSessionGoesOn) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 16384;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);  // inherited by what is started now
  auto server = serve({scenario(), "--log", file("full.mcap")});
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  Guest anna(domain_, "anna"), ben(domain_, "ben");
  ASSERT_TRUE(anna.joined()) << server->errors();
  ASSERT_TRUE(ben.joined());
  ASSERT_TRUE(anna.grab("red"));
  const auto failed = [&] { return server->errors().find("cannot write") != std::string::npos; };
  int moves = 0;
  for (const double end_s = steady_s() + 30; !failed() && steady_s() < end_s; ++moves)
    ASSERT_TRUE(step_by(anna, "red", {moves % 2 ? -0.001 : 0.00123, 0, 0}));
  ASSERT_TRUE(failed()) << server->errors();
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(step_by(anna, "red", {0, 0.01, 0})) << "it goes on";
  ASSERT_TRUE(step_by(anna, "red", {0, 0, -12}));
  anna.until(1.5, [&] {
    ben.listen();
    return false;
  });
  Guest late(domain_, "late");  // what it knows is what the server says now
  ASSERT_TRUE(late.joined());
  const Knowledge known = agreed_by({&anna, &ben, &late});
  EXPECT_EQ(known.open.size(), 1u) << "red in the base";
  server->signal(SIGTERM);
  EXPECT_EQ(server->wait(kPatience_s), 1) << "the log is not whole, and the exit code says so";
  expect_told_at_end(known, Json::parse(server->out()));
  expect_nothing_lost(anna, "anna", Json::parse(server->out()));
  const std::string errors = server->errors();
  std::size_t times = 0;
  for (std::size_t at = 0;
       (at = errors.find("the session continues, and", at)) != std::string::npos; ++at)
    ++times;
  EXPECT_EQ(times, 1U) << errors;
  const Json log = Json::parse(server->out())["log"];
  EXPECT_GE(log["dropped_ticks"].get<int>(), 100) << log;
  EXPECT_NE(log["error"].get<std::string>().find("full.mcap"), std::string::npos);
  // What was written stays readable, and what was not is what was counted.
  const auto read = read_session_log(file("full.mcap"));
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_FALSE(read->complete);
  EXPECT_EQ(read->ticks.size() + log["dropped_ticks"].get<std::size_t>(),
            Json::parse(server->out())["statistics"]["ticks"].get<std::size_t>());
}

}  // namespace
}  // namespace mortise::test
