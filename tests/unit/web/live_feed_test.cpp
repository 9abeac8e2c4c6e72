// Pages on a session: the real server loop and the real client over memory, pages without a socket.
#include "client/web/live_feed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "common/io/scenario/brought_part.h"
#include "common/io/scenario/scene_load.h"
#include "common/messages/memory_channel.h"
#include "common/messages/mesh_bytes.h"
#include "common/messages/names.h"
#include "server/tick_loop.h"
#include "tests/support/small_scenarios.h"
#include "tests/unit/io/step_samples.h"
#include "tests/unit/web/page.h"

namespace mortise::web {
namespace {

constexpr PartId kPeg{2}, kBlock{3};

struct PagesOnASession : testing::Test {
  MemoryHub hub;
  std::unique_ptr<ServerChannel> server;
  std::unique_ptr<ClientChannel> channel;
  LoadedScene scene;
  SystemClock clock;
  std::unique_ptr<TickLoop> loop;
  std::unique_ptr<Client> client;
  std::unique_ptr<LiveFeed> feed;
  Page ann{Role::kDesigner}, bob{Role::kDesigner}, eve{Role::kObserver};
  double now_s = 1.0;

  void SetUp() override {
    auto reading = read_scenario_text(test::peg_yaml(), "pages.yaml");
    ASSERT_TRUE(reading) << reading.error().text;
    start_server(*reading);
    channel = hub.open_client();
    client = std::make_unique<Client>(*channel);
    feed = std::make_unique<LiveFeed>(*client, Limits{});
  }
  void start_server(const ScenarioReading& reading) {
    loop.reset();
    auto loaded = load_scene(reading.scenario, default_meshes());
    ASSERT_TRUE(loaded) << loaded.error().text;
    scene = std::move(*loaded);
    server = hub.open_server();
    TickLoopOptions options;
    options.session = "pages";
    loop = std::make_unique<TickLoop>(scene.world, *server, clock, nullptr, options);
    loop->open();
  }
  void turn(int times = 1) {
    for (int i = 0; i < times; ++i) {
      loop->tick();
      now_s += 1.0 / 60.0;
      feed->turn(now_s);
      for (Page* page : {&ann, &bob, &eve})
        if (page->reads) page->take(*feed);
    }
  }
  void say(Page& page, const std::string& text) {
    const auto message = read_page_message(text);
    ASSERT_TRUE(message) << message.error().text;
    const Status taken = feed->take(page, *message);
    EXPECT_TRUE(taken) << taken.error().text;
  }
  void come(Page& page, const std::string& name) {
    feed->enter(page);
    say(page, R"({"type":"join","name":")" + name + R"("})");
    turn(4);
    ASSERT_EQ(page.last("joined")["name"], name);
  }
  void come_as(Page& page, const std::string& name, const std::string& key) {
    feed->enter(page);
    say(page, R"({"type":"join","name":")" + name + R"(","page":")" + key + R"("})");
    turn(4);
    ASSERT_EQ(page.last("joined")["name"], name);
  }
  void grab(Page& page, PartId part) {
    say(page, R"({"type":"command","id":1,"do":"grab","part":)" + std::to_string(part.value) + "}");
    turn(2);
    ASSERT_EQ(page.last("reply")["done"], true) << page.last("reply");
  }
  void move(Page& page, PartId part, double z_mm) {
    say(page, R"({"type":"move","part":)" + std::to_string(part.value) + R"(,"t":[0,0,)" +
                  std::to_string(z_mm) + "]}");
  }
};

TEST_F(PagesOnASession, SeeTheSceneThenEachOther) {
  come(ann, "ann");
  come(bob, "bob");
  const Json told = ann.last("scene");
  EXPECT_EQ(told["session"], "pages");
  ASSERT_EQ(told["parts"].size(), 3u);
  EXPECT_EQ(told["parts"][1]["name"], "peg");
  EXPECT_EQ(told["parts"][1]["p"], Json::parse("[0.0, 0.0, 25.0]"));
  EXPECT_EQ(ann.last("users")["users"].size(), 2u);
  const MeshAnswer mesh = feed->mesh(told["parts"][1]["mesh"]);
  ASSERT_EQ(mesh.state, MeshAnswer::State::kHere);
  EXPECT_EQ(mesh.bytes->substr(0, 4), "MSH1");
  EXPECT_EQ(feed->mesh("0123").state, MeshAnswer::State::kUnknown);

  grab(ann, kPeg);
  EXPECT_EQ(bob.seen[kPeg].holder.value, ann.last("joined")["user"]);
  move(ann, kPeg, -2.5);
  turn(2);
  EXPECT_EQ(bob.seen[kPeg].X_WP.p, Vec3(0, 0, 22.5));
  EXPECT_EQ(ann.seen[kPeg].X_WP.p, Vec3(0, 0, 22.5));
  EXPECT_EQ(bob.last("decisions")["decisions"][0]["kind"], "grab");
}

TEST_F(PagesOnASession, AreToldTheSameClashAndItsClass) {
  come(ann, "ann");
  come(bob, "bob");
  grab(ann, kPeg);
  move(ann, kPeg, -20.0);  // the facets cross, the round parts do not
  turn(2);
  ASSERT_EQ(ann.count("events"), 1u);
  const Json event = ann.last("events")["events"][0];
  EXPECT_EQ(event["kind"], "begin");
  EXPECT_EQ(event, bob.last("events")["events"][0]);
  EXPECT_EQ(event["class"], "fake");
  EXPECT_EQ(bob.seen[kPeg].classes, 1u);
  EXPECT_EQ(bob.seen[PartId{1}].classes, 1u);  // the plate never moved, yet is shown as it stands
  say(bob,
      R"({"type":"command","id":77,"do":"review","clash":1,"status":"reviewed","text":"hm","assignee":1})");
  turn(2);
  ASSERT_EQ(ann.last("remarks")["remarks"].size(), 1u);
  const Json remark = ann.last("remarks")["remarks"][0];
  EXPECT_EQ(remark["text"], "hm");
  EXPECT_EQ(remark["user"], 2);
  EXPECT_EQ(remark["assignee"], 1);
  EXPECT_EQ(bob.last("reply")["id"], 77);
  EXPECT_EQ(ann.last("events")["events"][0]["review"]["comment"], "hm");
  feed->enter(eve);  // late
  turn();
  EXPECT_EQ(eve.last("scene")["clashes"][0]["review"]["comment"], "hm");
  EXPECT_EQ(eve.last("scene")["clashes"][0]["user"], 1) << "bob looked at it, ann has moved";
  EXPECT_EQ(eve.last("scene")["clashes"][0]["cause"], "unknown");
  ASSERT_EQ(eve.last("scene")["remarks"].size(), 1u);
  EXPECT_EQ(eve.last("scene")["remarks"][0]["text"], "hm");
  // The fit of the scenario is there from the start, of nobody.
  const Json fit = eve.last("scene")["standing"][0];
  EXPECT_EQ(fit["kind"], "set tolerance");
  EXPECT_EQ(fit["user"], 0);
  EXPECT_EQ(fit["other"], 2);
  EXPECT_EQ(eve.last("scene")["parts"][0]["classes"], 1u);
  move(ann, kPeg, 20.0);
  turn(2);
  EXPECT_EQ(eve.last("events")["events"][0]["kind"], "end");
  EXPECT_EQ(eve.seen[kPeg].classes, 0u);
  EXPECT_EQ(eve.seen[PartId{1}].classes, 0u);
}

TEST_F(PagesOnASession, ThatGoAwayLetGoAtOnce) {
  come(ann, "ann");
  come(bob, "bob");
  grab(ann, kPeg);
  move(ann, kPeg, -1.0);
  feed->leave(ann);
  turn(2);
  EXPECT_EQ(bob.seen[kPeg].holder.value, 0u);
  EXPECT_EQ(bob.seen[kPeg].X_WP.p.z(), 24.0);  // what was sent before still counts
  // Loaded anew: the same name, the same user, and its increments count from the first.
  ann = Page(Role::kDesigner);
  come(ann, "ann");
  grab(ann, kPeg);
  move(ann, kPeg, -1.0);
  turn(2);
  EXPECT_EQ(bob.seen[kPeg].X_WP.p.z(), 23.0);
}

const std::string kAnnsPage = "ann's page, 16 bytes or more";

TEST_F(PagesOnASession, WhoseLineBreaksGoOnWithWhatTheyHeld) {
  come_as(ann, "ann", kAnnsPage);
  come(bob, "bob");
  grab(ann, kPeg);
  const Json user = ann.last("joined")["user"];
  feed->lose(ann);
  turn(10);
  EXPECT_EQ(bob.seen[kPeg].holder.value, user);
  ann = Page(Role::kDesigner);
  come_as(ann, "ann", kAnnsPage);
  EXPECT_EQ(ann.last("joined")["user"], user);
  EXPECT_EQ(ann.last("scene")["parts"][1]["holder"], user);
  move(ann, kPeg, -1.0);
  turn(2);
  EXPECT_EQ(bob.seen[kPeg].X_WP.p.z(), 24.0);
}

TEST_F(PagesOnASession, ABrokenLineThatNobodyNoticedYetGivesWay) {
  come_as(ann, "ann", kAnnsPage);
  grab(ann, kPeg);
  come_as(bob, "ann", kAnnsPage);  // the same page on its next line
  EXPECT_EQ(bob.last("joined")["user"], ann.last("joined")["user"]);
  move(bob, kPeg, -1.0);
  turn(2);
  EXPECT_EQ(bob.seen[kPeg].X_WP.p.z(), 24.0);
  feed->lose(ann);
  turn(2);
  EXPECT_EQ(bob.seen[kPeg].holder.value, bob.last("joined")["user"]);
}

TEST_F(PagesOnASession, WhoseLineStaysBrokenHoldOnlyAsLongAsTheirLease) {
  scene.world.lease_s = 0.4;
  come_as(ann, "ann", kAnnsPage);
  come(bob, "bob");
  grab(ann, kPeg);
  const auto pass = [&](double seconds, const auto& done) {
    for (double s = 0.0; s < seconds && !done(); s += 0.01) {
      turn();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  };
  const auto is_free = [&] { return !bob.seen[kPeg].holder; };
  pass(0.8, is_free);
  ASSERT_FALSE(is_free()) << "with a line the lease is renewed";
  feed->lose(ann);
  pass(20.0, is_free);
  ASSERT_TRUE(is_free());
  EXPECT_EQ(bob.last("decisions")["decisions"][0]["kind"], "lease end");
  turn(10);
  EXPECT_EQ(bob.last("decisions")["decisions"][0]["kind"], "leave") << "and who holds nothing goes";
  ann = Page(Role::kDesigner);
  come_as(ann, "ann", kAnnsPage);
  EXPECT_EQ(ann.last("scene")["parts"][1]["holder"], 0);
}

TEST_F(PagesOnASession, AreNotKeptFromTheirNameByTheirOwnBrokenLine) {
  come_as(ann, "ann", kAnnsPage);
  come(bob, "bob");
  grab(ann, kPeg);
  feed->lose(ann);
  ann = Page(Role::kDesigner);
  feed->enter(ann);
  say(ann, R"({"type":"join","name":"ann","page":"another page of hers"})");
  turn(20);
  EXPECT_EQ(ann.last("joined")["name"], "ann");
  EXPECT_EQ(ann.count("join_refused"), 0u);
  EXPECT_FALSE(bob.seen[kPeg].holder) << "the other page cannot know what was in hand";
}

TEST_F(PagesOnASession, LoadedAnewWithinOneTickAreLetInUnderTheirName) {
  come(ann, "ann");
  feed->leave(ann);
  ann = Page(Role::kDesigner);
  feed->enter(ann);
  say(ann, R"({"type":"join","name":"ann"})");
  turn(20);
  EXPECT_EQ(ann.last("joined")["name"], "ann");
  EXPECT_EQ(ann.count("join_refused"), 0u);
}

TEST_F(PagesOnASession, OfTwoWithOneNameTheSecondIsRefusedAndMayTryAgain) {
  come(ann, "ann");
  feed->enter(bob);
  say(bob, R"({"type":"join","name":"ann"})");
  turn(4);
  ASSERT_EQ(bob.count("join_refused"), 1u);
  EXPECT_NE(bob.last("join_refused")["text"].get<std::string>().find("in use"), std::string::npos);
  say(bob, R"({"type":"join","name":"bob"})");
  turn(4);
  EXPECT_EQ(bob.last("joined")["name"], "bob");
}

TEST_F(PagesOnASession, ATokenIsGoodForItsOwnPersonOnly) {
  ann.bound = "ann";
  feed->enter(ann);
  say(ann, R"({"type":"join","name":"bob"})");
  turn(4);
  ASSERT_EQ(ann.count("join_refused"), 1u);
  EXPECT_EQ(ann.last("join_refused")["text"], "this link is ann's: join as ann");
  EXPECT_EQ(feed->statistics()["joins_under_another_name"], 1);
  say(ann, R"({"type":"join","name":"ann"})");
  turn(4);
  EXPECT_EQ(ann.last("joined")["name"], "ann");
}

TEST_F(PagesOnASession, WhoGoesBeforeTheServerAnswersIsNoGhost) {
  come(bob, "bob");
  feed->enter(ann);
  say(ann, R"({"type":"join","name":"ann"})");
  feed->turn(now_s);  // the question goes out
  feed->leave(ann);
  turn(5);
  const Json told = bob.last("users");
  for (const Json& user : told["users"]) EXPECT_EQ(user["present"], user["name"] == "bob") << user;
}

TEST_F(PagesOnASession, LookOnlyWithTheLinkForIt) {
  come(eve, "eve");
  EXPECT_EQ(eve.last("joined")["role"], "observer");
  say(eve, R"({"type":"command","id":5,"do":"grab","part":2})");
  EXPECT_EQ(Json::parse(*eve.outbox.next({})->bytes)["done"], false);
  move(eve, kPeg, -1.0);
  turn(10);
  EXPECT_EQ(eve.last("refused")["increments"][0]["reason"], name_of(Refusal::kObserver));
  EXPECT_EQ(scene.world.parts[1].X_WP.p.z(), 25.0);
  EXPECT_FALSE(scene.world.parts[1].holder);
}

TEST_F(PagesOnASession, WithoutANameNothingIsMoved) {
  feed->enter(ann);
  turn(2);
  EXPECT_FALSE(feed->take(ann, MoveWish{kPeg, Vec3(1, 0, 0), Vec3::Zero()}));
  say(ann, R"({"type":"command","id":3,"do":"grab","part":2})");
  turn();
  EXPECT_EQ(ann.last("reply")["done"], false);
  EXPECT_FALSE(feed->take(ann, ReplayWish{}));
}

TEST_F(PagesOnASession, RefusedMovesAreCountedToTheirPage) {
  come(ann, "ann");
  come(bob, "bob");
  grab(ann, kPeg);
  for (int i = 0; i < 30; ++i) {
    move(bob, kPeg, 1.0);
    turn();
  }
  turn(10);
  std::uint64_t refused = 0;
  for (const Json& message : bob.told) {
    if (message["type"] == "refused") refused += message["increments"][0]["count"].get<int>();
  }
  EXPECT_EQ(refused, 30u);
  EXPECT_LE(bob.count("refused"), 8u);  // not one each
  EXPECT_EQ(ann.count("refused"), 0u);
}

TEST_F(PagesOnASession, AStoppedPageIsBehindByOneFrameAndNoEvent) {
  come(ann, "ann");
  come(bob, "bob");
  grab(ann, kPeg);
  grab(ann, kBlock);
  bob.reads = false;
  const std::size_t before = bob.frames;
  for (int i = 0; i < 100; ++i) {
    move(ann, kPeg, i % 2 == 0 ? -20.0 : 20.0);  // in and out: two events each time
    if (i < 50) move(ann, kBlock, 1.0);
    turn();
  }
  turn(2);
  EXPECT_GT(bob.folded_frames(), 90u);
  bob.reads = true;
  turn();
  EXPECT_EQ(bob.frames, before + 1);
  for (const auto& [part, state] : ann.seen) {
    EXPECT_EQ(bob.seen[part].X_WP.p, state.X_WP.p) << part.value;
    EXPECT_EQ(bob.seen[part].holder, state.holder);
    EXPECT_EQ(bob.seen[part].classes, state.classes);
  }
  EXPECT_EQ(bob.seen[kBlock].X_WP.p.z(), 50.0);
  EXPECT_GE(ann.count("events"), 50u);
  EXPECT_EQ(bob.count("events"), ann.count("events"));
}

TEST_F(PagesOnASession, AllGetTheOneFrameThatWasEncoded) {
  come(ann, "ann");
  come(bob, "bob");
  feed->enter(eve);
  grab(ann, kPeg);
  for (Page* page : {&ann, &bob, &eve}) page->reads = false;
  move(ann, kPeg, -2.5);
  turn(2);
  std::vector<SharedBytes> frames;
  for (Page* page : {&ann, &bob, &eve}) {
    const auto encode_anew = [](const std::vector<PartId>&) -> SharedBytes {
      ADD_FAILURE() << "the frame of all pages would have done";
      return std::make_shared<const std::string>();
    };
    while (const auto message = page->outbox.next(encode_anew))
      if (message->binary) frames.push_back(message->bytes);
  }
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].get(), frames[1].get());
  EXPECT_EQ(frames[0].get(), frames[2].get());
}

TEST_F(PagesOnASession, ShowEachOtherWhereTheyLookFrom) {
  come(ann, "ann");
  come(bob, "bob");
  for (int i = 0; i < 60; ++i) {
    say(ann,
        R"({"type":"view","p":[1,2,)" + std::to_string(i) + R"(],"target":[0,0,0],"up":[0,0,1]})");
    turn();
  }
  turn(10);
  EXPECT_EQ(bob.last("views")["views"][0]["p"][2], 59.0);
  EXPECT_LE(bob.count("views"), 12u);
  EXPECT_EQ(ann.count("views"), 0u);
}

std::vector<std::byte> stl_of_a_corner() {
  const std::string text =
      "solid c\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 10 0\nvertex 10 0 0\n"
      "endloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 10 0 0\n"
      "vertex 0 0 10\nendloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\n"
      "vertex 0 0 10\nvertex 0 10 0\nendloop\nendfacet\nfacet normal 0 0 0\nouter loop\n"
      "vertex 10 0 0\nvertex 0 10 0\nvertex 0 0 10\nendloop\nendfacet\nendsolid c\n";
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

bool still_on_its_way(const Page& page) {
  const Json state = page.last("upload")["state"];
  return state == "open" || state == "sent" || state == "parts";
}

std::string ticket_of(const Page& page) {
  const std::string path = page.last("upload").value("path", "");
  return path.substr(path.rfind('/') + 1);
}

TEST_F(PagesOnASession, BringAFileAndEverybodySeesItsPart) {
  come(ann, "ann");
  come(bob, "bob");
  const auto bytes = stl_of_a_corner();
  const std::string wish = R"({"type":"upload","id":7,"name":"corner.stl","bytes":)" +
                           std::to_string(bytes.size()) + R"(,"unit_mm":10})";
  say(ann, wish);
  turn();
  ASSERT_EQ(ann.last("upload")["state"], "open") << ann.last("upload");
  EXPECT_TRUE(bob.last("upload").is_null()) << "a ticket is its asker's alone";
  const std::string ticket = ticket_of(ann);
  EXPECT_EQ(ticket.size(), 32u);
  EXPECT_FALSE(feed->begin_file("no such ticket"));
  ASSERT_EQ(feed->begin_file(ticket), bytes.size());
  EXPECT_FALSE(feed->begin_file(ticket)) << "it counts once";
  ASSERT_TRUE(feed->take_file(ticket, bytes));
  EXPECT_FALSE(feed->take_file(ticket, bytes));
  // It is read in a program of its own, beside the ticks.
  for (int i = 0; i < 4000 && still_on_its_way(ann); ++i) {
    turn();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const Json ready = ann.last("upload");
  ASSERT_EQ(ready["state"], "ready") << ready;
  EXPECT_EQ(ready["id"], 7);
  const std::size_t scenes = bob.count("scene");
  say(ann, R"({"type":"command","id":8,"do":"add_part","name":"corner","moving":true,"mesh":)" +
               ready["mesh"].dump() + R"(,"p":[500,0,0]})");
  for (int i = 0; i < 1000 && ann.last("reply").is_null(); ++i) {
    turn();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  turn(4);
  ASSERT_EQ(ann.last("reply")["done"], true) << ann.last("reply");
  EXPECT_GT(bob.count("scene"), scenes);
  const Json parts = bob.last("scene")["parts"];
  const auto corner = std::find_if(parts.begin(), parts.end(),
                                   [](const Json& part) { return part["name"] == "corner"; });
  ASSERT_NE(corner, parts.end()) << parts;
  EXPECT_EQ((*corner)["p"], Json::parse("[500.0, 0.0, 0.0]"));
  const std::string mesh = (*corner)["mesh"];
  EXPECT_EQ(feed->mesh(mesh).state, MeshAnswer::State::kHere);
  // What the server alone knows of it is told as well.
  const auto radius = [&] {
    const Json told = bob.last("scene");
    for (const Json& part : told["parts"])
      if (part["name"] == "corner") return part["radius"].get<double>();
    return 0.0;
  };
  for (int i = 0; i < 400 && radius() == 0.0; ++i) {
    turn();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_GT(radius(), 50.0);
  // Its mesh is there when it comes back: the server sends it once.
  const std::string part = (*corner)["id"].dump();
  say(ann, R"({"type":"command","id":9,"do":"remove_part","part":)" + part + "}");
  turn(4);
  ASSERT_EQ(bob.last("scene")["parts"].size(), parts.size() - 1);
  say(ann, R"({"type":"command","id":10,"do":"undo","part":)" + part + "}");
  for (int i = 0; i < 400 && bob.last("scene")["parts"].size() < parts.size(); ++i) {
    turn();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ASSERT_EQ(bob.last("scene")["parts"].size(), parts.size()) << ann.last("reply");
  EXPECT_EQ(feed->mesh(mesh).state, MeshAnswer::State::kHere);
}

// A gateway that takes this for every STEP file.
std::unique_ptr<LiveFeed> feed_with_step(Client& client, const Result<BroughtAssembly>& read) {
  return std::make_unique<LiveFeed>(client, Limits{},
                                    [read](auto& /*name*/, auto& /*bytes*/) { return read; });
}

std::vector<std::byte> corner_bytes(double edge_mm) {
  const std::vector<Vec3> points{{0, 0, 0}, {edge_mm, 0, 0}, {0, edge_mm, 0}, {0, 0, edge_mm}};
  const std::vector<std::array<std::uint32_t, 3>> triangles{
      {0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh_to_bytes(points, triangles);
}

TEST_F(PagesOnASession, BringAStepFileAndHearOfAllItsParts) {
  const Pose turned{Quat(0.8, 0, 0, 0.6), Vec3(7, 8, 9)};
  BroughtAssembly assembly;
  assembly.meshes = {corner_bytes(10.0), corner_bytes(20.0)};
  assembly.places = {{"box/a", 0, {}}, {"box/b", 1, turned}, {"box/c", 0, turned}};
  assembly.notes = {"a surface was left out"};
  feed = feed_with_step(*client, assembly);
  come(ann, "ann");
  say(ann, R"({"type":"upload","id":5,"name":"box.STEP","bytes":3})");
  turn();
  ASSERT_TRUE(feed->take_file(ticket_of(ann), std::vector<std::byte>(3)));
  for (int i = 0; i < 4000 && ann.last("upload")["state"] != "ready"; ++i) {
    turn();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const Json ready = ann.last("upload");
  ASSERT_EQ(ready["state"], "ready") << ready;
  EXPECT_EQ(ready["id"], 5);
  EXPECT_EQ(ready["text"], "a surface was left out");
  ASSERT_EQ(ready["parts"].size(), 3u) << ready;
  EXPECT_EQ(ready["parts"][0]["mesh"], ready["parts"][2]["mesh"]);
  EXPECT_NE(ready["parts"][0]["mesh"], ready["parts"][1]["mesh"]);
  Json edit = ready["parts"][1];
  edit.update({{"type", "command"}, {"id", 6}, {"do", "add_part"}, {"moving", true}});
  say(ann, edit.dump());
  for (int i = 0; i < 1000 && ann.last("reply").is_null(); ++i) {
    turn();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  turn(4);
  ASSERT_EQ(ann.last("reply")["done"], true) << ann.last("reply");
  const Json part = ann.last("scene")["parts"].back();
  EXPECT_EQ(part["name"], "box/b");
  EXPECT_EQ(part["p"], Json::parse("[7.0,8.0,9.0]"));
  EXPECT_EQ(part["q"], Json::parse("[0.0,0.0,0.6,0.8]"));
}

// Ring and pins as a gateway brings them; the hole is H7 by its file, the pins are g6.
BroughtAssembly ring_with_pins() {
  StepDocument document = test::ring_and_pins();
  for (const std::uint32_t part : {0U, 1U}) {
    StepStatement& size = document.statements.emplace_back();
    size.kind = StepStatement::Kind::kSize;
    size.name = "diameter";
    size.value = 20.0;
    size.code = part == 0 ? "H7" : "g6";
    size.faces = {{part, test::cylinder_of(document.parts[part], part == 0)}};
  }
  BroughtAssembly assembly;
  for (const std::uint32_t part : {0U, 1U})
    assembly.meshes.push_back(brought_bytes(document, part));
  const Pose in_the_hole{Quat(std::cos(0.02), 0, 0, std::sin(0.02)), Vec3(500, 0, -10)};
  assembly.places = {{"ring", 0, Pose::translation({500, 0, 0})}, {"pin", 1, in_the_hole}};
  return assembly;
}

TEST_F(PagesOnASession, AreToldTheVerdictThatTheFacesOfAStepFileGive) {
  feed = feed_with_step(*client, ring_with_pins());
  come(ann, "ann");
  say(ann, R"({"type":"upload","id":5,"name":"fit.step","bytes":3})");
  turn();
  ASSERT_TRUE(feed->take_file(ticket_of(ann), std::vector<std::byte>(3)));
  const auto wait_for = [&](const std::function<bool()>& done) {
    for (int i = 0; i < 4000 && !done(); ++i) {
      turn();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return done();
  };
  ASSERT_TRUE(wait_for([&] { return ann.last("upload")["state"] == "ready"; }));
  const Json ready = ann.last("upload");
  std::size_t id = 6;
  for (Json edit : ready["parts"]) {
    edit.update({{"type", "command"}, {"id", ++id}, {"do", "add_part"}, {"moving", true}});
    say(ann, edit.dump());
    ASSERT_TRUE(wait_for([&] { return ann.last("reply")["id"] == id; }));
    ASSERT_EQ(ann.last("reply")["done"], true) << ann.last("reply");
  }
  ASSERT_TRUE(wait_for([&] { return ann.count("events") > 0; }));
  const Json event = ann.last("events")["events"][0];
  EXPECT_EQ(event["class"], "fake") << event;
  EXPECT_EQ(event["grade"], name_of(DeviationGrade::kDeclaredFeature)) << event;
  EXPECT_EQ(event["faces"], Json::parse(R"(["bore_1","shaft_1"])")) << event;
  EXPECT_NE(event["explanation"].get<std::string>().find("Ø20 H7/g6"), std::string::npos) << event;
}

TEST_F(PagesOnASession, HearWhyAStepFileCannotBeRead) {
  feed = feed_with_step(*client, fail(Code::kInvalidInput, "box.step: is torn"));
  come(ann, "ann");
  come(bob, "bob");
  const auto bring = [&](Page& page) {
    say(page, R"({"type":"upload","id":5,"name":"box.step","bytes":3})");
    turn();
    ASSERT_TRUE(feed->take_file(ticket_of(page), std::vector<std::byte>(3)));
  };
  bring(bob);
  feed->leave(bob);  // while it waits, or is read
  bring(ann);
  for (int i = 0; i < 4000 && still_on_its_way(ann); ++i) {
    turn();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(ann.last("upload")["state"], "refused");
  EXPECT_EQ(ann.last("upload")["text"], "box.step: is torn");
  EXPECT_EQ(bob.last("upload")["state"], "parts") << "nothing is told to who has left";
}

TEST_F(PagesOnASession, MayNotBringWhatIsTooMuchOrNotTheirs) {
  feed->enter(eve);
  const auto refusal = [&](Page& page, const std::string& rest) {
    say(page, R"({"type":"upload","id":1,"name":"a.stl","bytes":)" + rest + "}");
    turn();
    const Json told = page.last("upload");
    return told["state"] == "refused" ? told["refusal"].get<std::string>() : std::string();
  };
  EXPECT_EQ(refusal(eve, "10"), name_of(Refusal::kObserver));
  feed->enter(bob);
  EXPECT_EQ(refusal(bob, "10"), name_of(Refusal::kUnknownUser)) << "who has not joined";
  come(ann, "ann");
  EXPECT_EQ(refusal(ann, "0"), name_of(Refusal::kUnreadableMesh));
  EXPECT_EQ(refusal(ann, "134217729"), name_of(Refusal::kUploadLimit));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(refusal(ann, "10"), "");
  EXPECT_EQ(refusal(ann, "10"), name_of(Refusal::kUploadLimit)) << "four at a time";
  const std::string ticket = ticket_of(ann);
  feed->leave(ann);
  EXPECT_FALSE(feed->begin_file(ticket)) << "who has left brings nothing";
}

TEST_F(PagesOnASession, AreToldWhenTheServerGoesAndComesBack) {
  come(ann, "ann");
  grab(ann, kPeg);
  say(ann, R"({"type":"command","id":40,"do":"undo","part":2})");
  auto reading = read_scenario_text(test::peg_yaml(), "pages.yaml");
  ASSERT_TRUE(reading);
  const std::size_t scenes = ann.count("scene");
  start_server(*reading);
  turn(200);
  EXPECT_EQ(ann.last("reply")["id"], 40);
  EXPECT_EQ(ann.last("reply")["done"], false);
  EXPECT_GT(ann.count("scene"), scenes);
  EXPECT_EQ(ann.count("joined"), 2u);
  EXPECT_EQ(ann.last("scene")["parts"][1]["holder"], 0);
  grab(ann, kPeg);
}

TEST_F(PagesOnASession, AreToldWhatCanBeAlignedAndAlignIt) {
  come(ann, "ann");
  turn(30);
  const Json told = ann.last("features");
  ASSERT_TRUE(told.is_object());
  Json bore, journal;
  for (const Json& set : told["sets"]) {
    for (const Json& feature : set["features"]) {
      if (set["parts"][0] == 1 && feature["name"] == "bore") bore = feature;
      if (set["parts"][0] == kPeg.value && feature["name"] == "journal") journal = feature;
    }
  }
  ASSERT_TRUE(bore.is_object() && journal.is_object()) << told;
  EXPECT_EQ(bore["kind"], "cylinder");
  EXPECT_EQ(bore["inward"], true);
  EXPECT_EQ(journal["inward"], false);
  EXPECT_DOUBLE_EQ(journal["radius"].get<double>(), 10.0);
  feed->enter(eve);  // late
  turn();
  EXPECT_EQ(eve.last("features")["sets"], told["sets"]);

  grab(ann, kPeg);
  say(ann, R"({"type":"move","part":2,"t":[0.4,-0.3,0]})");
  turn(2);
  say(ann, R"({"type":"command","id":8,"do":"snap","part":2,"feature":"journal","other":1})");
  turn(60);
  EXPECT_EQ(ann.last("reply")["done"], true) << ann.last("reply");
  EXPECT_EQ(ann.last("decisions")["decisions"][0]["constraint"]["other_feature"], "bore");
  EXPECT_NEAR(ann.seen[kPeg].X_WP.p.x(), 0.0, 1e-6);
  EXPECT_NEAR(ann.seen[kPeg].X_WP.p.y(), 0.0, 1e-6);
}

/// What a page shows as holding since the scenario: of the last list that it was told.
Json standing_of(const Page& page) {
  Json standing = Json::array();
  for (const Json& told : page.told)
    if (told.contains("standing")) standing = told["standing"];
  Json since = Json::array();
  for (const Json& decision : standing)
    if (decision["user"] != 0) since.push_back(decision);
  return since;
}

TEST_F(PagesOnASession, AreToldThatNoConstraintHoldsOfAPartThatWasLetGo) {
  come(bob, "bob");
  const auto channel_of_ben = hub.open_client();
  const ClientKey key_of_ben = hub.last_client();
  Client ben(*channel_of_ben);
  ben.add_user("ben", "designer");
  const Constraint coaxial{ConstraintKind::kCoaxial, {kPeg, "journal"}, {PartId{1}, "bore"}};
  const auto turns = [&](int times) {
    for (int i = 0; i < times; ++i) {
      ben.poll();
      turn();
    }
  };
  const auto hold = [&](const std::function<void()>& constrain) {
    constrain();
    turns(4);
    ASSERT_EQ(standing_of(bob).size(), 1u);
    EXPECT_EQ(standing_of(bob)[0]["kind"], "add constraint");
  };
  const auto ann_holds = [&] {
    grab(ann, kPeg);
    say(ann, R"({"type":"command","id":9,"do":"constrain","kind":"coaxial","part":2,)"
             R"("feature":"journal","other":1,"other_feature":"bore"})");
  };
  turns(4);

  come(ann, "ann");
  hold(ann_holds);
  say(ann, R"({"type":"command","id":10,"do":"release","part":2})");
  turns(2);
  EXPECT_EQ(standing_of(bob), Json::array()) << "released";

  hold(ann_holds);
  feed->leave(ann);
  turns(2);
  EXPECT_EQ(standing_of(bob), Json::array()) << "left";

  hold([&] {
    ben.grab(0, kPeg);
    ben.add_constraint(0, coaxial);
  });
  hub.kill(key_of_ben);
  turns(2);
  EXPECT_EQ(standing_of(bob), Json::array()) << "liveliness lost";
}

TEST_F(PagesOnASession, ManyComingsAndGoingsLeaveNothingBehind) {
  come(ann, "ann");
  for (int i = 0; i < 50; ++i) {
    bob = Page(Role::kDesigner);
    feed->enter(bob);
    say(bob, R"({"type":"join","name":"bob)" + std::to_string(i % 3) + R"("})");
    turn(3);
    feed->leave(bob);
    turn(2);
  }
  EXPECT_LE(client->user_count(), 3u);
  EXPECT_EQ(ann.last("users")["users"].size(), 4u);
}

}  // namespace
}  // namespace mortise::web
