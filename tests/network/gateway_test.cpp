// The gateway as strangers meet it: over real sockets, with a real session behind it.
#include "client/web/gateway.h"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include "client/web/live_feed.h"
#include "common/io/scene_load.h"
#include "common/messages/memory_channel.h"
#include "server/tick_loop.h"
#include "tests/network/page_client.h"
#include "tests/support/small_scenarios.h"

namespace mortise::test {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kPeg = 2, kBlock = 3;

/// A session and a gateway, each in a thread of its own, over memory.
struct GatewayFixture : testing::Test {
  MemoryHub hub;
  std::unique_ptr<ServerChannel> server;
  std::unique_ptr<ClientChannel> channel;
  LoadedScene scene;
  SystemClock clock;
  std::unique_ptr<TickLoop> loop;
  std::unique_ptr<Client> client;
  std::unique_ptr<web::LiveFeed> feed;
  std::unique_ptr<web::Gateway> gateway;
  web::GatewayOptions options;
  web::Tokens tokens = web::make_tokens();
  fs::path folder;
  std::atomic<bool> stopping{false};
  std::atomic<int> lines{0};
  std::thread session, serving;
  int port = 0;

  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             (std::string("mortise_gateway_") +
              testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder);
    fs::create_directories(folder / "page");
    std::ofstream(folder / "page/index.html") << "<script type=\"importmap\">{}</script>page";
    std::ofstream(folder / "secret.txt") << "secret";
    auto reading = read_scenario_text(peg_yaml(), "gateway.yaml");
    ASSERT_TRUE(reading) << reading.error().text;
    auto loaded = load_scene(reading->scenario, default_meshes());
    ASSERT_TRUE(loaded) << loaded.error().text;
    scene = std::move(*loaded);
    server = hub.open_server();
    TickLoopOptions loop_options;
    loop_options.session = "gateway";
    loop = std::make_unique<TickLoop>(scene.world, *server, clock, nullptr, loop_options);
    loop->open();
    channel = hub.open_client();
    session = std::thread([this] { loop->run([this] { return stopping.load(); }, [] {}); });
    // Short, for a test that has to wait for them.
    options.limits.request_s = 0.6;
    options.limits.idle_s = 2.0;
  }
  void serve() {
    client = std::make_unique<Client>(*channel);
    feed = std::make_unique<web::LiveFeed>(*client, options.limits);
    auto page = web::PageFiles::open(folder / "page");
    ASSERT_TRUE(page);
    auto opened =
        web::Gateway::open(options, tokens, *page, *feed, [this](const std::string&) { ++lines; });
    ASSERT_TRUE(opened) << opened.error().text;
    gateway = std::move(*opened);
    port = gateway->port();
    serving = std::thread([this] { gateway->run(); });
  }
  void TearDown() override {
    if (gateway) gateway->stop();
    if (serving.joinable()) serving.join();
    stopping = true;
    session.join();
    fs::remove_all(folder);
  }
  PageClientOptions designer() const {
    PageClientOptions page;
    page.port = port;
    page.token = tokens.designer;
    page.tls = !options.certificate.empty();
    return page;
  }
  Json statistics() const {
    return Json::parse(
        http_request(port, "/statistics", {{"Authorization", "Bearer " + tokens.observer}}, "GET",
                     !options.certificate.empty())
            .body,
        nullptr, false);
  }
  int incidents(const char* kind) const { return statistics()["incidents"][kind].get<int>(); }
};

/// Two good pages: what is done to the gateway must not be felt by them.
struct GoodPages {
  explicit GoodPages(const GatewayFixture& gateway)
      : ann(gateway.designer()), bob(gateway.designer()) {
    EXPECT_TRUE(ann.join("ann") && bob.join("bob"));
    EXPECT_TRUE(ann.command({{"do", "grab"}, {"part", kPeg}}));
  }
  /// Ann moves, Bob sees it.
  void expect_to_go_on() {
    ann.move(kPeg, 0.0, 0.0, 0.5);
    z_mm += 0.5;
    EXPECT_TRUE(bob.wait([&] {
      ann.run(0.0);
      return bob.seen.contains(kPeg) && bob.seen[kPeg].X_WP.p.z() == z_mm;
    }));
    EXPECT_TRUE(ann.is_open() && bob.is_open());
  }
  PageClient ann, bob;
  double z_mm = 25.0;
};

// The report is made beside: others are served meanwhile, and a second one waits its turn.
TEST_F(GatewayFixture, OffersAReportToWhoHasAToken) {
  std::atomic<bool> go{false};
  options.report = [&]() -> Result<std::string> {
    while (!go) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return std::string("<!DOCTYPE html>report");
  };
  serve();
  const Fields bearer = {{"Authorization", "Bearer " + tokens.observer}};
  EXPECT_EQ(http_request(port, "/report.html").status, 401);
  EXPECT_EQ(http_request(port, "/report.html", {{"Host", "evil.example"}}).status, 421);
  HttpAnswer answer;
  std::thread asks([&] { answer = http_request(port, "/report.html", bearer); });
  HttpAnswer second;
  for (int i = 0; i < 400 && second.status != 503; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (i < 20) continue;
    if (i == 20) {
      EXPECT_EQ(http_request(port, "/").status, 200);
    }
    second = http_request(port, "/report.html", bearer);
  }
  EXPECT_EQ(second.status, 503);
  EXPECT_FALSE(second.field("Retry-After").empty());
  go = true;
  asks.join();
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, "<!DOCTYPE html>report");
  EXPECT_NE(answer.field("Content-Disposition").find("attachment"), std::string::npos);
  EXPECT_EQ(http_request(port, "/report.html", bearer).status, 200);  // and again
}

TEST_F(GatewayFixture, SaysThatThereIsNoReport) {
  serve();
  const Fields bearer = {{"Authorization", "Bearer " + tokens.designer}};
  EXPECT_EQ(http_request(port, "/report.html", bearer).status, 404);
}

TEST_F(GatewayFixture, TwoPagesJoinMoveAndSeeTheSameClash) {
  serve();
  GoodPages good(*this);
  EXPECT_EQ(good.ann.told.front()["type"], "welcome");
  EXPECT_EQ(good.ann.told.front()["role"], "designer");
  good.expect_to_go_on();
  good.ann.move(kPeg, 0, 0, -20.0);
  const Json here = good.ann.await("events"), there = good.bob.await("events");
  ASSERT_TRUE(here.is_object() && there.is_object());
  EXPECT_EQ(here["events"][0], there["events"][0]);
  EXPECT_EQ(here["events"][0]["class"], "fake");
  const HttpAnswer health = http_request(port, "/healthz");
  EXPECT_EQ(health.status, 200) << health.body;
}

TEST_F(GatewayFixture, ACrashedPageLetsGoOfItsPart) {
  serve();
  PageClient ann(designer()), bob(designer());
  ASSERT_TRUE(ann.join("ann") && bob.join("bob"));
  ASSERT_TRUE(ann.command({{"do", "grab"}, {"part", kPeg}}));
  ASSERT_TRUE(bob.wait([&] { return bob.seen.contains(kPeg) && bob.seen[kPeg].holder; }));
  ann.move(kPeg, 1, 0, 0);
  ann.drop();
  // Far below the lease of 5 s and the time after which a silent one is closed.
  EXPECT_TRUE(bob.wait([&] { return !bob.seen[kPeg].holder; }, 2.0));
  EXPECT_TRUE(bob.command({{"do", "grab"}, {"part", kPeg}}));
  PageClient again(designer());
  EXPECT_TRUE(again.join("ann"));
}

TEST_F(GatewayFixture, StrangersAreTurnedAwayAtTheDoor) {
  serve();
  GoodPages good(*this);
  const auto status_of = [&](auto change) {
    PageClientOptions page = designer();
    change(page);
    return PageClient(page).status();
  };
  EXPECT_EQ(status_of([](auto&) {}), 101);
  EXPECT_EQ(status_of([](auto& page) { page.token = std::string(32, '0'); }), 401);
  EXPECT_EQ(status_of([](auto& page) { page.token = ""; }), 401);
  EXPECT_EQ(status_of([](auto& page) { page.protocols = "mortise.9"; }), 400);
  EXPECT_EQ(status_of([](auto& page) { page.origin = "http://evil.example"; }), 403);
  EXPECT_EQ(status_of([](auto& page) { page.origin = "null"; }), 403);
  EXPECT_EQ(status_of([](auto& page) { page.origin = "none"; }), 403);
  EXPECT_EQ(status_of([](auto& page) { page.host = "evil.example"; }), 421);
  EXPECT_EQ(http_request(port, "/", {{"Host", "evil.example"}}).status, 421);
  EXPECT_EQ(http_request(port, "/statistics").status, 401);
  EXPECT_EQ(http_request(port, "/mesh/0.bin", {{"Authorization", "Bearer x"}}).status, 401);
  EXPECT_EQ(incidents("wrong_token"), 4);
  EXPECT_EQ(incidents("wrong_origin"), 3);
  EXPECT_EQ(incidents("wrong_host"), 2);
  EXPECT_GE(lines, 3);
  good.expect_to_go_on();
}

TEST_F(GatewayFixture, FilesAndMeshesAreServedAndNothingElse) {
  serve();
  const HttpAnswer page = http_request(port, "/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.field("Cache-Control"), "no-cache");
  EXPECT_NE(page.field("Content-Security-Policy").find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(page.field("X-Content-Type-Options"), "nosniff");
  EXPECT_EQ(http_request(port, "/", {{"If-None-Match", page.field("ETag")}}).status, 304);
  const HttpAnswer head = http_request(port, "/", {}, "HEAD");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.field("Content-Length"), std::to_string(page.body.size()));
  EXPECT_EQ(http_request(port, "/", {}, "POST").status, 405);
  const HttpAnswer three = http_request(port, "/three/build/three.module.js");
  EXPECT_EQ(three.status, 404);
  EXPECT_NE(three.body.find("npm ci"), std::string::npos);
  for (const char* target : {"/../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt",
                             "/page/../../secret.txt", "//secret.txt"}) {
    const HttpAnswer answer = http_request(port, target);
    EXPECT_EQ(answer.status, 404) << target;
    EXPECT_EQ(answer.body.find("secret\n"), std::string::npos);
  }
  PageClient ann(designer());
  const Json told = ann.await("scene");
  ASSERT_TRUE(told.is_object());
  const std::string target = "/mesh/" + told["parts"][1]["mesh"].get<std::string>() + ".bin";
  const Fields bearer = {{"Authorization", "Bearer " + tokens.observer}};
  const HttpAnswer mesh = http_request(port, target, bearer);
  EXPECT_EQ(mesh.status, 200);
  EXPECT_EQ(mesh.body.substr(0, 4), "MSH1");
  EXPECT_NE(mesh.field("Cache-Control").find("immutable"), std::string::npos);
  EXPECT_EQ(http_request(port, target).status, 401);
  EXPECT_EQ(http_request(port, "/mesh/00.bin", bearer).status, 404);
}

TEST_F(GatewayFixture, BadMessagesCloseTheirPageOnly) {
  serve();
  GoodPages good(*this);
  const auto closed_with = [&](auto misbehave) {
    PageClient bad(designer());
    EXPECT_EQ(bad.status(), 101);
    misbehave(bad);
    EXPECT_TRUE(bad.wait([&] { return !bad.is_open(); }));
    return bad.close_code();
  };
  EXPECT_EQ(closed_with([](PageClient& bad) { bad.send(std::string(20000, 'x')); }), 1009);
  EXPECT_EQ(closed_with([](PageClient& bad) {
              for (int i = 0; i < 12; ++i) bad.send("{\"type\":");
              EXPECT_NE(bad.await("error")["text"].get<std::string>().find("not JSON"),
                        std::string::npos);
            }),
            1008);
  EXPECT_EQ(closed_with([](PageClient& bad) {
              for (int i = 0; i < 12; ++i) bad.send_binary("MPF1");
            }),
            1008);
  EXPECT_EQ(closed_with([](PageClient& bad) {
              for (int i = 0; i < 2000; ++i) bad.send(R"({"type":"ping","at":1})");
            }),
            1008);
  EXPECT_EQ(incidents("oversized"), 1);
  EXPECT_GE(incidents("malformed"), 12);
  EXPECT_EQ(incidents("flood"), 1);
  good.expect_to_go_on();
}

TEST_F(GatewayFixture, AFewMistakesAreForgiven) {
  serve();
  PageClient ann(designer());
  for (int i = 0; i < 4; ++i) ann.send("mistake");
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ann.await("error").is_object());
  EXPECT_TRUE(ann.join("ann"));
}

TEST_F(GatewayFixture, SlowAndSilentConnectionsKeepNobodyOut) {
  options.limits.connections = 20;
  serve();
  GoodPages good(*this);
  std::vector<std::unique_ptr<RawConnection>> lorises;
  for (int i = 0; i < 60; ++i) {
    lorises.push_back(std::make_unique<RawConnection>(port));
    lorises.back()->send("GET / HTTP/1.1\r\nHost: 127.");
    if (i % 10 == 0) good.expect_to_go_on();
  }
  EXPECT_EQ(http_request(port, "/").status, 200);
  EXPECT_GE(incidents("too_many_connections"), 30);
  for (const auto& loris : lorises) {
    bool closed = false;
    loris->read(4.0, closed);
    EXPECT_TRUE(closed);
  }
  EXPECT_GE(incidents("slow_request"), 1);
  bool closed = false;
  RawConnection garbage(port);
  garbage.send("\x16\x03\x01 this is no HTTP\r\n\r\n");
  EXPECT_NE(garbage.read(4.0, closed).find("400"), std::string::npos);
  EXPECT_TRUE(closed);
  RawConnection large(port);
  large.send("GET / HTTP/1.1\r\nX: " + std::string(10000, 'x') + "\r\n\r\n");
  large.read(4.0, closed);
  EXPECT_TRUE(closed);
  EXPECT_GE(incidents("bad_request"), 2);
  good.expect_to_go_on();
}

TEST_F(GatewayFixture, WhoAnswersNoPingIsClosedAndItsPartFree) {
  options.limits.silent_s = 1.0;
  serve();
  PageClient ann(designer()), bob(designer());
  ASSERT_TRUE(ann.join("ann") && bob.join("bob"));
  ASSERT_TRUE(ann.command({{"do", "grab"}, {"part", kBlock}}));
  // From here on Ann's browser is gone, though its connection stands.
  ASSERT_TRUE(bob.wait([&] { return bob.seen.contains(kBlock) && bob.seen[kBlock].holder; }));
  EXPECT_TRUE(bob.wait([&] { return !bob.seen[kBlock].holder; }, 6.0));
  EXPECT_EQ(incidents("silent"), 1);
}

TEST_F(GatewayFixture, AStoppedPageCostsTheOthersNothingAndIsClosed) {
  options.limits.stalled_s = 1.5;
  serve();
  GoodPages good(*this);
  PageClientOptions small = designer();
  small.receive_buffer_bytes = 4096;
  PageClient stopped(small);
  ASSERT_TRUE(stopped.join("stopped"));
  ASSERT_TRUE(good.ann.command({{"do", "grab"}, {"part", kBlock}}));
  // In and out of the plate: events all the time, until the buffers of the stopped one are full.
  for (int i = 0; i < 1500 && incidents("stalled") == 0; ++i) {
    for (int k = 0; k < 10; ++k) {
      good.ann.move(kPeg, 0, 0, k % 2 == 0 ? -20.0 : 20.0);
      good.ann.run(0.02);
      good.bob.run(0.0);
    }
  }
  EXPECT_EQ(incidents("stalled"), 1);
  good.expect_to_go_on();
  // What the others were told meanwhile is the same, and all of it.
  ASSERT_TRUE(good.bob.wait([&] { return good.bob.events == good.ann.events; }));
  EXPECT_GT(good.ann.events, 50u);
  const Json last = good.ann.await("users");
  EXPECT_TRUE(good.ann.is_open());
}

TEST_F(GatewayFixture, TlsForThoseWhoWantIt) {
  options.certificate = folder / "certificate.pem";
  options.key = folder / "key.pem";
  ASSERT_TRUE(write_certificate(options.certificate, options.key));
  serve();
  EXPECT_EQ(gateway->address(tokens.designer).substr(0, 8), "https://");
  const HttpAnswer page = http_request(port, "/", {}, "GET", true);
  EXPECT_EQ(page.status, 200);
  EXPECT_NE(page.field("Content-Security-Policy").find("wss://"), std::string::npos);
  GoodPages good(*this);
  good.expect_to_go_on();
  PageClientOptions plain = designer();
  plain.tls = false;
  EXPECT_NE(PageClient(plain).status(), 101);
  EXPECT_GE(incidents("tls"), 1);
  good.expect_to_go_on();
}

TEST_F(GatewayFixture, WhatCannotBeServedIsSaidAtTheStart) {
  client = std::make_unique<Client>(*channel);
  feed = std::make_unique<web::LiveFeed>(*client, options.limits);
  const auto why = [&] {
    auto page = web::PageFiles::open(folder / "page");
    auto opened = web::Gateway::open(options, tokens, *page, *feed, [](const std::string&) {});
    return opened ? std::string() : opened.error().text;
  };
  options.address = "192.0.2.1";
  EXPECT_NE(why().find("cannot listen"), std::string::npos);
  options.address = "nonsense";
  EXPECT_NE(why().find("cannot read the address"), std::string::npos);
  options.address = "127.0.0.1";
  options.certificate = folder / "page/index.html";
  options.key = options.certificate;
  EXPECT_NE(why().find("no certificate"), std::string::npos);
}

TEST_F(GatewayFixture, TooManyBrowsersAndTheEnd) {
  options.limits.browsers = 3;
  serve();
  GoodPages good(*this);
  PageClient third(designer());
  EXPECT_EQ(third.status(), 101);
  EXPECT_EQ(PageClient(designer()).status(), 503);
  third.drop();
  EXPECT_TRUE(good.bob.wait([&] { return PageClient(designer()).status() == 101; }));
  gateway->stop();
  EXPECT_TRUE(good.ann.wait([&] { return !good.ann.is_open(); }));
  EXPECT_TRUE(good.bob.wait([&] { return !good.bob.is_open(); }));
  EXPECT_EQ(good.ann.close_code(), 1001);
  EXPECT_EQ(good.bob.close_code(), 1001);
}

}  // namespace
}  // namespace mortise::test
