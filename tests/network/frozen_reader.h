#pragma once
#include <gtest/gtest.h>
#include <signal.h>

#include <memory>
#include <stdexcept>

#include "client/client.h"
#include "tests/network/small_server.h"

namespace mortise::test {

/// A server of a hundred parts with two participants: one in a process of its own, to be stopped,
/// and a healthy one in this process.
struct FrozenReader {
  explicit FrozenReader(const DdsOptions& options) : frozen("client", options, "frozen", 60.0) {
    auto opened = open_server_channel(options);
    auto own = open_client_channel(options);
    if (!opened || !own) throw std::runtime_error(opened ? own.error().text : opened.error().text);
    channel = std::move(*opened);
    server = std::make_unique<SmallServer>(*channel, options.session, 100);
    own_channel = std::move(*own);
    healthy = std::make_unique<Client>(*own_channel);
    healthy->add_user("healthy", "designer");
  }
  bool both_joined() {
    return until(
        8.0, [&] { return server->users.size() == 2 && healthy->synced(); }, [&] { turn(); });
  }
  void turn() {
    server->turn();
    events += healthy->poll().events.size();
  }
  /// What a busy tick says: an increment of the healthy one, four events, poses.
  void busy_turn() {
    healthy->send(0, PartId{1}, Vec3(0, 0, 0.01));
    server->publish_events(4);
    turn();
  }
  /// The healthy one has heard all that was said.
  bool all_heard() {
    return until(
        5.0, [&] { return events == server->event_seq; }, [&] { turn(); });
  }
  void stop() { frozen.signal(SIGSTOP); }
  void go_on() { frozen.signal(SIGCONT); }

  Child frozen;
  std::unique_ptr<ServerChannel> channel;
  std::unique_ptr<SmallServer> server;
  std::unique_ptr<ClientChannel> own_channel;
  std::unique_ptr<Client> healthy;
  std::uint64_t events = 0;
};

}  // namespace mortise::test
