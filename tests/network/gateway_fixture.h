#pragma once
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include "client/web/gateway.h"
#include "client/web/live_feed.h"
#include "common/io/scenario/scene_load.h"
#include "common/messages/memory_channel.h"
#include "server/tick_loop.h"
#include "tests/network/page_client.h"
#include "tests/support/small_scenarios.h"
#include "tests/support/test_folder.h"

namespace mortise::test {

inline constexpr std::uint32_t kPeg = 2, kBlock = 3;

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
  const TestFolder own;
  const std::filesystem::path folder = own.path();
  std::atomic<bool> stopping{false};
  std::atomic<int> lines{0};
  std::thread session, serving;
  int port = 0;

  void SetUp() override {
    std::filesystem::create_directories(folder / "page");
    std::ofstream(folder / "page/index.html") << "<script type=\"importmap\">{}</script>page";
    std::ofstream(folder / "secret.txt") << "secret";
    auto reading = read_scenario_text("lease_s: 60\n" + peg_yaml(), "gateway.yaml");
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

}  // namespace mortise::test
