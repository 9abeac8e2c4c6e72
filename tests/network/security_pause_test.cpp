// With keys, one of two stands still for longer than its lease, and is met again.
#include <signal.h>

#include "client/client.h"
#include "tests/network/guest.h"
#include "tests/network/security_fixture.h"
#include "tests/support/effort.h"

namespace mortise::test {
namespace {

class SecurityPause : public Security {
 protected:
  static constexpr double kPause_s = 3.0, kComesBack_s = 20.0;

  /// Stands still for longer than its lease; the other goes on.
  void pause(const Child& peer, const std::function<void()>& turn) {
    peer.signal(SIGSTOP);
    (void)test::until(
        kPause_s, [] { return false; }, turn);
    peer.signal(SIGCONT);
  }
};

TEST_F(SecurityPause, AServerThatStoodStillIsMetAgain) {
  Child server("server", options((*site_keys)["hall"]), "hall", 90.0);
  auto channel = open_client_channel(options((*site_keys)["anna"]));
  ASSERT_TRUE(channel) << channel.error().text;
  Client client(**channel);
  client.add_user("anna", "designer");
  bool was_lost = false;
  const auto turn = [&] { was_lost |= client.poll().server_lost; };
  const auto is_in = [&] { return client.user_id(0) && client.synced(); };
  ASSERT_TRUE(until(kPatience_s, is_in, turn));
  was_lost = false;
  pause(server, turn);
  ASSERT_TRUE(was_lost && !is_in()) << "or nothing is tested";
  const double begun_s = now_s();
  EXPECT_TRUE(until(kComesBack_s, is_in, turn));
  std::printf("met again %.1f s after a pause of %.0f s\n", now_s() - begun_s, kPause_s);
}

/// When it goes on, goodbyes are waiting for it, and the leases of all others have ended: Fast DDS
/// removes the first in the thread that receives, and the others in that of its timers, where each
/// waited for the other for good.
TEST_F(SecurityPause, AServerLivesThroughGoodbyesAndLeasesThatEndAtOnce) {
  constexpr std::size_t kStay = 7, kLeave = 7;
  Child server("server", options((*site_keys)["hall"]), "hall", 600.0);
  std::vector<std::unique_ptr<Guest>> stay, leave;
  const auto come = [&](auto& guests, std::size_t count) {
    while (guests.size() < count)
      guests.push_back(std::make_unique<Guest>(options((*site_keys)["anna"]), "anna"));
  };
  const auto listen = [&] {
    for (auto* guests : {&stay, &leave})
      for (auto& guest : *guests) guest->listen();
  };
  const auto is_in = [](const auto& guest) {
    return guest->client->user_id(0) && guest->client->synced();
  };
  for (int i = 0; i <= effort(2); ++i) {
    come(stay, kStay);
    come(leave, kLeave);
    ASSERT_TRUE(until(
        kPatience_s,
        [&] { return std::ranges::all_of(stay, is_in) && std::ranges::all_of(leave, is_in); },
        listen))
        << "after " << i << " pauses";
    server.signal(SIGSTOP);
    leave.clear();
    (void)until(
        kPause_s, [] { return false; }, listen);
    server.signal(SIGCONT);
    stay.clear();
  }
}

TEST_F(SecurityPause, AClientThatStoodStillIsMetAgain) {
  auto channel = open_server_channel(options((*site_keys)["hall"]));
  ASSERT_TRUE(channel) << channel.error().text;
  SmallServer server(**channel, "test", 3);
  Child client("client", options((*site_keys)["anna"]), "anna", 90.0);
  std::uint64_t beats = 0;
  const auto turn = [&] {
    server.turn();
    if (server.tick % 10 == 0) server.publish_events(1);
    beats += server.last_input.heartbeats.size();
  };
  ASSERT_TRUE(until(
      kPatience_s, [&] { return beats > 3; }, turn));
  pause(client, turn);
  ASSERT_FALSE(server.lost.empty()) << "or nothing is tested";
  const double begun_s = now_s();
  beats = 0;
  EXPECT_TRUE(until(
      kComesBack_s, [&] { return beats > 3; }, turn));
  std::printf("met again %.1f s after a pause of %.0f s\n", now_s() - begun_s, kPause_s);
}

/// What a server keeps of one that it removed can keep it outside for good. It is taken back for
/// some seconds as the participant that it was.
TEST_F(SecurityPause, AClientThatMeetsNobodyForLongComesAsAnotherParticipant) {
  constexpr double kAlone_s = 7.0;
  auto channel = open_client_channel(options((*site_keys)["anna"]));
  ASSERT_TRUE(channel) << channel.error().text;
  Client client(**channel);
  client.add_user("anna", "designer");
  const auto comes_as = [&]() -> ClientKey {
    auto hall = open_server_channel(options((*site_keys)["hall"]));
    if (!hall) return hall.error().text;
    SmallServer server(**hall, "test", 3);
    (void)until(
        kPatience_s, [&] { return !server.users.empty(); },
        [&] {
          server.turn();
          (void)client.poll();
        });
    return server.users.empty() ? "nobody" : server.users.begin()->second.first;
  };
  const ClientKey first = comes_as();
  EXPECT_EQ(comes_as(), first);
  (void)until(
      kAlone_s, [] { return false; }, [&] { (void)client.poll(); });
  const ClientKey another = comes_as();
  EXPECT_NE(another, first);
  EXPECT_EQ(another.size(), first.size()) << another;
}

}  // namespace
}  // namespace mortise::test
