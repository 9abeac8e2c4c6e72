#include "server/service_manager.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

#include "tests/support/test_folder.h"

namespace mortise {
namespace {

/// A service manager of this process: what it was told.
class Listening : public ::testing::Test {
 protected:
  void SetUp() override {
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    const std::string path = (folder_.path() / "notify").string();
    std::strncpy(at.sun_path, path.c_str(), sizeof at.sun_path - 1);
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    ASSERT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
    setenv("NOTIFY_SOCKET", path.c_str(), 1);
    setenv("WATCHDOG_USEC", "200000", 1);
  }
  void TearDown() override {
    close(socket_);
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
  }
  std::vector<std::string> told() const {
    std::vector<std::string> texts;
    char text[512];
    for (ssize_t n = 0; (n = recv(socket_, text, sizeof text, 0)) > 0;)
      texts.emplace_back(text, static_cast<std::size_t>(n));
    return texts;
  }
  using Texts = std::vector<std::string>;

  test::TestFolder folder_;
  int socket_ = -1;
};

TEST_F(Listening, HearsThatTheServerIsUpAndGoesOn) {
  ServiceManager manager;
  EXPECT_EQ(told(), Texts{});
  manager.ready("leading");
  EXPECT_EQ(told(), Texts{"READY=1\nSTATUS=leading"});
  for (int tick = 0; tick < 100; ++tick) manager.beat();
  EXPECT_EQ(told().size(), 1U) << "not with each tick";
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  manager.beat();
  EXPECT_EQ(told(), Texts{"WATCHDOG=1"}) << "well within the 200 ms that it gives";
  manager.busy();
  manager.beat();
  EXPECT_EQ(told(),
            (Texts{"WATCHDOG_USEC=3600000000\nWATCHDOG=1", "WATCHDOG_USEC=200000\nWATCHDOG=1"}));
  manager.ends();
  EXPECT_EQ(told().back(), "STOPPING=1");
}

TEST_F(Listening, IsToldNoBeatsThatItDoesNotWant) {
  setenv("WATCHDOG_PID", "1", 1);  // of another process
  ServiceManager of_another;
  of_another.beat();
  EXPECT_EQ(told(), Texts{});
  of_another.ready("up");
  EXPECT_EQ(told().size(), 1U);
  unsetenv("WATCHDOG_PID");
  for (const char* nonsense : {"", "0", "-5", "soon"}) {
    setenv("WATCHDOG_USEC", nonsense, 1);
    ServiceManager manager;
    manager.beat();
    EXPECT_EQ(told(), Texts{}) << nonsense;
  }
}

TEST_F(Listening, MayBeAbsent) {
  for (const std::string& place : {std::string(), std::string("x"), std::string("/no/such/place"),
                                   "/" + std::string(300, 'x'), std::string("@nobody")}) {
    setenv("NOTIFY_SOCKET", place.c_str(), 1);
    ServiceManager manager;
    manager.ready("up");
    manager.beat();
    manager.ends();
  }
  EXPECT_EQ(told(), Texts{});
}

}  // namespace
}  // namespace mortise
