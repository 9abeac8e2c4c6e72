// A log through the eyes of a page: any moment at once, and on from there as it was.
#include "client/web/replay_feed.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "client/client.h"
#include "common/io/build_info.h"
#include "common/io/log/log_chain.h"
#include "common/io/log/session_log.h"
#include "common/io/scenario/scene_load.h"
#include "common/messages/memory_channel.h"
#include "server/tick_loop.h"
#include "tests/support/small_scenarios.h"
#include "tests/support/test_folder.h"
#include "tests/unit/web/page.h"

namespace mortise::web {
namespace {

namespace fs = std::filesystem;

constexpr PartId kPegId{2};

/// What the session was like, tick by tick.
struct Truth {
  std::map<std::uint64_t, Vec3> peg_mm;
  std::map<std::uint64_t, std::size_t> open;
};

/// Ann moves the peg into the plate and out again, undoes that, lets go.
Truth play_session(const fs::path& file) {
  Truth truth;
  auto reading = read_scenario_text(test::peg_yaml(), "replayed.yaml");
  auto scene = load_scene(reading->scenario, default_meshes());
  MemoryHub hub;
  auto server = hub.open_server();
  SystemClock clock;
  auto log = SessionLogWriter::create(
      file, log_header(*scene, "replayed", "replayed.yaml", test::peg_yaml()));
  EXPECT_TRUE(log) << log.error().text;
  TickLoopOptions options;
  options.session = "replayed";
  TickLoop loop(scene->world, *server, clock, log->get(), options);
  loop.open();
  auto channel = hub.open_client();
  Client client(*channel);
  const LocalUser ann = client.add_user("ann", "designer");
  const auto turn = [&](int times) {
    for (int i = 0; i < times; ++i) {
      loop.tick();
      client.poll();
      truth.peg_mm[scene->world.tick] = scene->world.parts[1].X_WP.p;
      truth.open[scene->world.tick] = client.open_clashes().size();
    }
  };
  turn(4);
  client.grab(ann, kPegId);
  turn(3);
  for (int i = 0; i < 50; ++i) {
    client.send(ann, kPegId, Vec3(0, 0, i < 25 ? -2.0 : 2.0));
    turn(1);
  }
  turn(10);
  client.undo(ann, kPegId);
  turn(5);
  client.release(ann, kPegId);
  turn(20);
  EXPECT_TRUE((*log)->close());
  return truth;
}

struct ReplayOfASession : testing::Test {
  void SetUp() override {
    truth = play_session(file);
    auto read = read_recording(file);
    ASSERT_TRUE(read) << read.error().text;
    EXPECT_TRUE(read->notes.empty()) << testing::PrintToString(read->notes);
    recording = *read;
  }

  const test::TestFolder folder;
  const fs::path file = folder.path() / "session.mcap";
  Truth truth;
  Recording recording;
};

TEST_F(ReplayOfASession, ShowsEachMomentAsItWas) {
  ASSERT_GT(recording.last_tick, 60u);
  std::size_t with_clash = 0;
  for (std::uint64_t tick = 1; tick <= recording.last_tick; ++tick) {
    const Scene scene = recording.scene_at(tick);
    EXPECT_EQ(scene.parts[1].X_WP.p, truth.peg_mm[tick]) << tick;
    with_clash += scene.clashes.size();
  }
  EXPECT_GE(with_clash, 3u);
  EXPECT_TRUE(recording.scene_at(0).users.empty());
  EXPECT_EQ(recording.scene_at(20).users[0].name, "ann");
  EXPECT_TRUE(recording.scene_at(20).parts[1].holder);
  EXPECT_FALSE(recording.scene_at(recording.last_tick).parts[1].holder);
}

TEST_F(ReplayOfASession, PlaysOnFromAnywhere) {
  for (const std::uint64_t from : {std::uint64_t{0}, std::uint64_t{25}, recording.last_tick - 3}) {
    ReplayFeed feed(recording);
    Page page(Role::kObserver);
    feed.enter(page);
    page.take(feed);
    EXPECT_EQ(page.last("timeline")["last_tick"], recording.last_tick);
    EXPECT_GE(page.last("timeline")["marks"].size(), 2u);
    ASSERT_TRUE(feed.take(page, ReplayWish{ReplayWish::Do::kSeek, from, 1.0}));
    ASSERT_TRUE(feed.take(page, ReplayWish{ReplayWish::Do::kPlay, 0, 1.0}));
    page.take(feed);
    EXPECT_EQ(page.last("scene")["tick"], from);
    Vec3 peg_mm = truth.peg_mm.contains(from) ? truth.peg_mm[from] : Vec3(0, 0, 25);
    std::size_t open = page.last("scene")["clashes"].size();
    page.told.clear();
    for (int i = 0; i < 200; ++i) {
      feed.turn(1.0 + i / 60.0);
      page.take(feed);
      if (page.seen.contains(kPegId)) peg_mm = page.seen[kPegId].X_WP.p;
    }
    EXPECT_EQ(page.last("replay")["tick"], recording.last_tick);
    EXPECT_EQ(page.last("replay")["playing"], false);
    EXPECT_EQ(peg_mm, truth.peg_mm[recording.last_tick]);
    for (const Json& message : page.told) {
      if (message["type"] != "events") continue;
      for (const Json& event : message["events"]) {
        if (event["kind"] == "begin") ++open;
        if (event["kind"] == "end") --open;
      }
    }
    EXPECT_EQ(open, recording.scene_at(recording.last_tick).clashes.size()) << from;
  }
}

TEST_F(ReplayOfASession, EachPageHasATimelineOfItsOwn) {
  ReplayFeed feed(recording);
  Page one(Role::kObserver), other(Role::kDesigner);
  feed.enter(one);
  feed.enter(other);
  ASSERT_TRUE(feed.take(one, ReplayWish{ReplayWish::Do::kSeek, 30, 1.0}));
  feed.turn(1.0);
  one.take(feed);
  other.take(feed);
  EXPECT_EQ(one.last("scene")["tick"], 30);
  EXPECT_EQ(other.last("scene")["tick"], 0);
  ASSERT_TRUE(feed.take(other, ReplayWish{ReplayWish::Do::kSeek, 1'000'000, 1.0}));
  other.take(feed);
  EXPECT_EQ(other.last("scene")["tick"], recording.last_tick);
  ASSERT_TRUE(feed.take(one, ReplayWish{ReplayWish::Do::kSpeed, 0, 4.0}));
  ASSERT_TRUE(feed.take(one, ReplayWish{ReplayWish::Do::kPlay, 0, 1.0}));
  feed.turn(1.5);
  one.take(feed);
  EXPECT_EQ(one.last("replay")["speed"], 4.0);
  feed.leave(one);
  feed.turn(2.0);
}

TEST_F(ReplayOfASession, NothingIsDoneInIt) {
  ReplayFeed feed(recording);
  Page page(Role::kDesigner);
  feed.enter(page);
  EXPECT_TRUE(feed.take(page, JoinWish{"ann"}));
  EXPECT_TRUE(feed.take(page, CommandWish{3, CommandKind::kGrab, kPegId, {}}));
  EXPECT_FALSE(feed.take(page, MoveWish{kPegId, Vec3(1, 0, 0), Vec3::Zero()}));
  page.take(feed);
  EXPECT_EQ(page.count("join_refused"), 1u);
  EXPECT_EQ(page.last("reply")["done"], false);
}

TEST(ReplayOfNoLog, IsRefusedInOneLine) {
  const auto none = read_recording("nowhere.mcap");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().text.find('\n'), std::string::npos);
}

// What `mortise-replay verify` agrees with is shown to its end.
TEST(ReplayOfAnotherBuild, IsShownToItsEnd) {
  const fs::path golden = fs::path(MORTISE_SOURCE_DIR) / "tests" / "golden";
  for (const char* log : {"thin_wall.mcap", "thin_wall_slide.mcap", "before/0.2.0/clashes.mcap"}) {
    const auto written = read_session(golden / log);
    const auto shown = read_recording(golden / log);
    ASSERT_TRUE(written && shown) << log;
    EXPECT_EQ(shown->last_tick, written->ticks.back().tick) << log;
    if (written->build_fingerprint == build_fingerprint()) continue;
    ASSERT_EQ(shown->notes.size(), 1u) << testing::PrintToString(shown->notes);
    EXPECT_EQ(shown->notes[0].rfind("recorded by another build", 0), 0u) << shown->notes[0];
  }
}

TEST_F(ReplayOfASession, TheTimelineTellsDepthsAndTickTimes) {
  ReplayFeed feed(recording);
  Page page(Role::kObserver);
  feed.enter(page);
  page.take(feed);
  const Json line = page.last("timeline");
  ASSERT_FALSE(line["depths"].empty());
  const Json& depth = line["depths"][0];
  double at = 0.0, deepest = 0.0;
  for (const Json& piece : depth["pieces"]) {
    EXPECT_GE(piece[0], at) << "in the order of time";
    at = piece[1];
    EXPECT_EQ(truth.open.at(piece[0].get<std::uint64_t>()), 1u);
    deepest = std::max(deepest, piece[3].get<double>());
  }
  EXPECT_EQ(truth.open.at(static_cast<std::uint64_t>(at)), 0u) << "it ends where the clash does";
  EXPECT_GE(depth["top"], deepest);
  ASSERT_FALSE(line["tick_times"].empty());
  for (const Json& column : line["tick_times"]) EXPECT_GE(column[3], column[2]) << column;
}

}  // namespace
}  // namespace mortise::web
