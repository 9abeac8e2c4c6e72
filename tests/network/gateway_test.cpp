// The gateway as pages meet it: over real sockets, with a real session behind it.
#include "tests/network/gateway_fixture.h"

namespace mortise::test {
namespace {

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
  EXPECT_EQ(http_request(port, "/scenario.zip", bearer).status, 404);
  EXPECT_EQ(http_request(port, "/session.mcap", bearer).status, 404);  // none is known here
}

TEST_F(GatewayFixture, GivesTheLogToWhoHasAToken) {
  const std::string log("\x89MCAP\0log", 9);
  options.log = [&]() -> Result<std::string> { return log; };
  options.scenario = []() -> Result<std::string> { return std::string("PK"); };
  serve();
  const Fields bearer = {{"Authorization", "Bearer " + tokens.observer}};
  EXPECT_EQ(http_request(port, "/session.mcap").status, 401);
  const auto answer = http_request(port, "/session.mcap", bearer);
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, log);
  EXPECT_EQ(http_request(port, "/scenario.zip").status, 401);
  EXPECT_EQ(http_request(port, "/scenario.zip", bearer).body, "PK");
  EXPECT_EQ(http_request(port, "/report.html", bearer).status, 404);
}

TEST_F(GatewayFixture, GivesThePictureOfAClashToWhoHasAToken) {
  options.picture = [](const web::WantedPicture& wanted) -> Result<std::string> {
    if (wanted.clash == 9) return fail(Code::kNotFound, "the log has no clash 9");
    return "<svg>" + std::to_string(wanted.clash) + "@" +
           (wanted.until_tick ? std::to_string(*wanted.until_tick) : "end") + "</svg>";
  };
  serve();
  const Fields bearer = {{"Authorization", "Bearer " + tokens.observer}};
  EXPECT_EQ(http_request(port, "/clash/4.svg").status, 401);
  const auto answer = http_request(port, "/clash/4.svg", bearer);
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, "<svg>4@end</svg>");
  EXPECT_EQ(answer.field("Content-Type"), "image/svg+xml");
  EXPECT_EQ(http_request(port, "/clash/4.svg?tick=812", bearer).body, "<svg>4@812</svg>");
  const auto missing = http_request(port, "/clash/9.svg", bearer);
  EXPECT_EQ(missing.status, 404);
  EXPECT_NE(missing.body.find("no picture: the log has no clash 9"), std::string::npos);
  for (const char* wrong : {"/clash/x.svg", "/clash/-1.svg", "/clash/4", "/clash/.svg",
                            "/clash/99999999999.svg", "/clash/4.svg?tick=", "/clash/4.svg?tick=1x"})
    EXPECT_EQ(http_request(port, wrong, bearer).status, 404) << wrong;
}

TEST_F(GatewayFixture, GivesTheGapOfTwoPartsToWhoHasAToken) {
  options.gap = [](const web::WantedGap& wanted) -> Result<std::string> {
    if (wanted.b == 9) return fail(Code::kNotFound, "the session has no part 9 then");
    return std::to_string(wanted.a) + "-" + std::to_string(wanted.b) + "@" +
           (wanted.tick ? std::to_string(*wanted.tick) : "now");
  };
  serve();
  const Fields bearer = {{"Authorization", "Bearer " + tokens.observer}};
  EXPECT_EQ(http_request(port, "/gap?a=1&b=2").status, 401);
  EXPECT_EQ(http_request(port, "/gap?a=1&b=2", {{"Host", "evil.example"}}).status, 421);
  const auto answer = http_request(port, "/gap?a=1&b=2", bearer);
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, "1-2@now");
  EXPECT_EQ(answer.field("Content-Type"), "application/json");
  EXPECT_EQ(http_request(port, "/gap?a=5&b=3&tick=812", bearer).body, "5-3@812");
  const auto missing = http_request(port, "/gap?a=1&b=9", bearer);
  EXPECT_EQ(missing.status, 404);
  EXPECT_EQ(missing.body, "no gap: the session has no part 9 then\n");
  for (const char* wrong :
       {"/gap?", "/gap?a=1", "/gap?a=1&b=", "/gap?a=1&b=1", "/gap?a=0&b=1", "/gap?a=-1&b=2",
        "/gap?a=x&b=2", "/gap?a=1&b=99999999999", "/gap?a=1&b=2&tick=", "/gap?a=1&b=2&tick=1x",
        "/gap?a=1&b=2&tick=1&c=3", "/gap?b=2&a=1", "/gap?a=1&b=2&a=3"}) {
    const auto refused = http_request(port, wrong, bearer);
    EXPECT_EQ(refused.status, 400) << wrong;
    EXPECT_EQ(std::count(refused.body.begin(), refused.body.end(), '\n'), 1) << refused.body;
  }
}

TEST_F(GatewayFixture, SaysThatThereIsNoReport) {
  serve();
  const Fields bearer = {{"Authorization", "Bearer " + tokens.designer}};
  EXPECT_EQ(http_request(port, "/report.html", bearer).status, 404);
  const auto picture = http_request(port, "/clash/1.svg", bearer);
  EXPECT_EQ(picture.status, 404);
  EXPECT_EQ(picture.body.find("no picture: this gateway knows no log"), 0u) << picture.body;
  const auto gap = http_request(port, "/gap?a=1&b=2", bearer);
  EXPECT_EQ(gap.status, 404);
  EXPECT_EQ(gap.body.find("no gap: this gateway knows no log"), 0u) << gap.body;
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
  options.limits.silent_s = 60.0;  // as the lease: nothing has to run out
  serve();
  PageClient ann(designer()), bob(designer());
  ASSERT_TRUE(ann.join("ann") && bob.join("bob"));
  ASSERT_TRUE(ann.command({{"do", "grab"}, {"part", kPeg}}));
  ASSERT_TRUE(bob.wait([&] { return bob.seen.contains(kPeg) && bob.seen[kPeg].holder; }));
  ann.move(kPeg, 1, 0, 0);
  ann.drop();
  EXPECT_TRUE(bob.wait([&] { return !bob.seen[kPeg].holder; }));
  EXPECT_TRUE(bob.command({{"do", "grab"}, {"part", kPeg}}));
  PageClient again(designer());
  EXPECT_TRUE(again.join("ann"));
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

}  // namespace
}  // namespace mortise::test
