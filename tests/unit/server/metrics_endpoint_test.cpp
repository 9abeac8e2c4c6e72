#include "server/metrics_endpoint.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include "tests/support/effort.h"
#include "tests/unit/server/http_get.h"

namespace mortise {
namespace {

using testing::Connection;
using testing::http_get;
using Clock = std::chrono::steady_clock;

class Endpoint : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = MetricsEndpoint::open("127.0.0.1", 0);
    ASSERT_TRUE(opened) << opened.error().text;
    endpoint_ = std::move(*opened);
    SessionFigures figures;
    figures.session = "demo";
    figures.tick = 41;
    endpoint_->show(figures);
  }
  std::string get(const std::string& target) const { return http_get(endpoint_->port(), target); }

  std::unique_ptr<MetricsEndpoint> endpoint_;
};

TEST_F(Endpoint, ServesTheFiguresThatWereShownLast) {
  EXPECT_NE(get("/metrics").find("\nmortise_tick 41\n"), std::string::npos);
  SessionFigures figures;
  figures.tick = 42;
  endpoint_->show(figures);
  const std::string answer = get("/metrics");
  EXPECT_EQ(answer.rfind("HTTP/1.1 200", 0), 0U) << answer.substr(0, 80);
  EXPECT_NE(answer.find("Content-Type: text/plain; version=0.0.4"), std::string::npos);
  EXPECT_NE(answer.find("\nmortise_tick 42\n"), std::string::npos);
}

TEST_F(Endpoint, AnswersNothingElse) {
  EXPECT_EQ(get("/").rfind("HTTP/1.1 404", 0), 0U);
  const Connection post(endpoint_->port());
  post.send("POST /metrics HTTP/1.1\r\nHost: x\r\nConnection: close\r\nContent-Length: 0\r\n\r\n");
  EXPECT_EQ(post.rest().rfind("HTTP/1.1 405", 0), 0U);
  const Connection head(endpoint_->port());
  head.send("HEAD /metrics HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n");
  const std::string answer = head.rest();
  EXPECT_EQ(answer.rfind("HTTP/1.1 200", 0), 0U);
  EXPECT_EQ(answer.find("mortise_tick"), std::string::npos) << "a HEAD has no body";
  const Connection nonsense(endpoint_->port());
  nonsense.send("\x01\x02 nonsense\r\n\r\n");
  nonsense.rest();
  EXPECT_EQ(get("/healthz").rfind("HTTP/1.1 200", 0), 0U) << "it lives on";
}

TEST_F(Endpoint, ARequestNamesOneHost) {
  for (const char* hosts : {"", "Host: x\r\nHost: y\r\n", "Host: x\r\nhost: x\r\n"}) {
    const Connection connection(endpoint_->port());
    connection.send(std::string("GET /metrics HTTP/1.1\r\n") + hosts + "Connection: close\r\n\r\n");
    EXPECT_EQ(connection.rest().rfind("HTTP/1.1 400", 0), 0U) << hosts;
  }
}

TEST_F(Endpoint, IsUnhealthyWhenNoTickCame) {
  endpoint_->beat();
  EXPECT_EQ(get("/healthz").rfind("HTTP/1.1 200", 0), 0U);
  std::this_thread::sleep_for(std::chrono::milliseconds(2200));
  EXPECT_EQ(get("/healthz").rfind("HTTP/1.1 503", 0), 0U);
  endpoint_->beat();
  EXPECT_EQ(get("/healthz").rfind("HTTP/1.1 200", 0), 0U);
}

// Clients that ask and never read, and clients that never finish asking: the tick thread's calls
// take as long as without them, and once they have run out of patience a collector is served.
TEST_F(Endpoint, StuckClientsHoldNobodyUp) {
  SessionFigures large;
  for (int i = 0; i < 2000; ++i) large.users.push_back({"user" + std::to_string(i), true, 0, {}});
  std::vector<std::unique_ptr<Connection>> stuck;
  for (int i = 0; i < 60; ++i) {
    stuck.push_back(std::make_unique<Connection>(endpoint_->port()));
    ASSERT_TRUE(stuck.back()->is_open());
    stuck.back()->send(i % 2 == 0 ? "GET /metrics HTTP/1.1\r\n\r\nGET /metrics HTTP/1.1\r\n\r\n"
                                  : "GET /metr");
  }
  const auto start = Clock::now();
  for (int i = 0; i < 200; ++i) {
    endpoint_->beat();
    endpoint_->show(large);
  }
  if (test::timed()) {  // a copy of 2000 users takes some 0.1 ms; a client is waited for for
                        // seconds
    EXPECT_LT(Clock::now() - start, std::chrono::seconds(2));
  }
  bool served = false;
  for (int i = 0; i < 100 && !served; ++i) {
    served = get("/healthz").rfind("HTTP/1.1 200", 0) == 0;
    endpoint_->beat();
    if (!served) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_TRUE(served);
}

TEST_F(Endpoint, SaysInOneLineWhyItCannotListen) {
  const auto taken = MetricsEndpoint::open("127.0.0.1", endpoint_->port());
  ASSERT_FALSE(taken);
  EXPECT_NE(taken.error().text.find(std::to_string(endpoint_->port())), std::string::npos);
  EXPECT_FALSE(MetricsEndpoint::open("192.0.2.7", 0)) << "no address of this machine";
  EXPECT_FALSE(MetricsEndpoint::open("nowhere", 0));
}

}  // namespace
}  // namespace mortise
