// A log is played to a live session: the same users do the same, and the same is found.
#include "client/replay/play.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "common/io/scenario/open_scene.h"
#include "common/messages/memory_channel.h"
#include "common/session/tick/statistics.h"
#include "server/tick_loop.h"
#include "tests/unit/io/log_samples.h"
#include "tests/unit/replay/played.h"

namespace mortise {
namespace {

/// A live session over memory, in a thread of its own.
struct Live {
  MemoryHub hub;
  std::unique_ptr<ServerChannel> server = hub.open_server();
  LoadedScene scene;
  SystemClock clock;
  std::unique_ptr<TickLoop> loop;
  std::atomic<bool> stopping{false};
  std::thread thread;

  test::TemporaryFile log_file{"play_live.mcap"};
  std::unique_ptr<SessionLogWriter> log;

  bool start(const std::string& name) {
    auto opened = open_scene(scenario(name + ".yaml"));
    if (!opened || !opened->usable()) return false;
    scene = std::move(opened->scene);
    TickLoopOptions options;
    options.session = "play";
    LogHeader header;
    header.session = "play";
    header.scenario_yaml = "none";
    auto writer = SessionLogWriter::create(log_file.path(), header);
    if (!writer) return false;
    log = std::move(*writer);
    loop = std::make_unique<TickLoop>(scene.world, *server, clock, log.get(), options);
    loop->open();
    thread = std::thread([this] { loop->run([this] { return stopping.load(); }, [] {}); });
    return true;
  }
  void stop() {
    stopping = true;
    if (thread.joinable()) thread.join();
    if (log) (void)log->close();
  }
  ~Live() { stop(); }
};

std::map<std::pair<PartId, PartId>, CollisionClass> worst_of(const SessionLog& log) {
  std::map<std::pair<PartId, PartId>, CollisionClass> worst;
  for (const TickRecord& record : log.ticks)
    for (const ClashEvent& event : record.report.events) {
      CollisionClass& known = worst[{event.part_a, event.part_b}];
      known = std::max(known, event.worst_class);
    }
  return worst;
}

TEST(Play, TheSameClashesAreFoundAgain) {
  for (const double speed : {1.0, 10.0}) {
    const auto log = played("peg_in_hole");
    ASSERT_TRUE(log) << log.error().text;
    Live live;
    ASSERT_TRUE(live.start("peg_in_hole"));
    const auto channel = live.hub.open_client();
    Client client(*channel);
    PlayOptions options;
    options.speed = speed;
    const auto outcome = play_log(*log, client, options);
    ASSERT_TRUE(outcome) << outcome.error().text;
    EXPECT_EQ(outcome->increments_refused, 0U) << (outcome->notes.empty() ? "" : outcome->notes[0]);
    EXPECT_EQ(outcome->commands_refused, 0U);
    EXPECT_EQ(outcome->users_not_let_in, 0U);
    for (const std::string& note : outcome->notes) ADD_FAILURE() << note;
    EXPECT_EQ(outcome->ticks, log->ticks.size());
    EXPECT_GT(outcome->increments_sent, 0U);
    EXPECT_LE(outcome->increments_sent, outcome->increments);
    live.stop();
    // Where the parts are left is where the log left them, though not to the last bit.
    std::map<PartId, Pose> end;
    for (const TickRecord& record : log->ticks)
      for (const PartPose& pose : record.report.moved) end[pose.part] = pose.X_WP;
    ASSERT_FALSE(end.empty());
    for (const auto& [part, pose] : end)
      EXPECT_LT((live.scene.world.find(part)->X_WP.p - pose.p).norm(), speed > 1.0 ? 0.5 : 0.05)
          << part.value << " at x" << speed;
    EXPECT_GT(outcome->events, 0U);
    const auto lived = read_session_log(live.log_file.path());
    ASSERT_TRUE(lived) << lived.error().text;
    EXPECT_FALSE(worst_of(*log).empty());
    EXPECT_EQ(worst_of(*lived), worst_of(*log)) << "at x" << speed;
  }
}

TEST(Play, APieceAloneTakesItsTime) {
  const auto log = played("thin_wall");
  ASSERT_TRUE(log);
  ASSERT_GT(log->ticks.size(), 2U);
  Live live;
  ASSERT_TRUE(live.start("thin_wall"));
  const auto channel = live.hub.open_client();
  Client client(*channel);
  PlayOptions options;
  options.to_s = 0.1;
  const auto outcome = play_log(*log, client, options);
  ASSERT_TRUE(outcome) << outcome.error().text;
  EXPECT_LT(outcome->ticks, log->ticks.size());
}

TEST(Play, AnotherSceneIsRefused) {
  const auto log = played("thin_wall");
  ASSERT_TRUE(log);
  Live live;
  ASSERT_TRUE(live.start("peg_in_hole"));
  const auto channel = live.hub.open_client();
  Client client(*channel);
  const auto outcome = play_log(*log, client, {});
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, Code::kInvalidInput);
  // And nobody there at all.
  MemoryHub nobody;
  const auto empty = nobody.open_client();
  Client alone(*empty);
  PlayOptions options;
  options.wait_s = 0.2;
  const auto no = play_log(*log, alone, options);
  ASSERT_FALSE(no);
  EXPECT_EQ(no.error().code, Code::kRuntime);
}

}  // namespace
}  // namespace mortise
