// One participant in a process of its own, for fault_test.
#include <cstdio>
#include <cstdlib>

#include "client/client.h"
#include "tests/network/small_server.h"

namespace mortise::test {
namespace {

constexpr int kFailed = 3;

int run_client(const DdsOptions& options, const std::string& name, double stay_s) {
  auto channel = open_client_channel(options);
  if (!channel) {
    std::fprintf(stderr, "%s\n", channel.error().text.c_str());
    return kFailed;
  }
  Client client(**channel);
  client.add_user(name, "bot");
  until(
      stay_s, [] { return false; }, [&] { client.poll(); });
  client.leave(0);
  sleep_s(0.3);  // the goodbye is on its way
  return 0;
}

int run_server(const DdsOptions& options, double stay_s) {
  auto channel = open_server_channel(options);
  if (!channel) {
    std::fprintf(stderr, "%s\n", channel.error().text.c_str());
    return kFailed;
  }
  SmallServer server(**channel, options.session, 3);
  until(
      stay_s, [] { return false; },
      [&] {
        server.turn();
        if (server.tick % 10 == 0) server.publish_events(1);
      });
  return 0;
}

}  // namespace
}  // namespace mortise::test

int main(int count, char** words) {
  using namespace mortise;
  if (count != 7) {
    std::fprintf(stderr, "usage: network_peer client|server DOMAIN SESSION NAME STAY_S KEYS\n");
    return 2;
  }
  DdsOptions options;
  options.domain = std::atoi(words[2]);
  options.session = words[3];
  const double stay_s = std::atof(words[5]);
  options.keys = words[6];
  return std::string(words[1]) == "server" ? test::run_server(options, stay_s)
                                           : test::run_client(options, words[4], stay_s);
}
