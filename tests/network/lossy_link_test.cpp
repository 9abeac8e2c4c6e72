// A session across a link that loses, delays, doubles and reorders: the real inbox and tick loop on
// one side, clients on the other. Nothing is lost, and all know the same at the end.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>

#include "client/client.h"
#include "idl/dds_channel.h"
#include "server/tick_loop.h"
#include "tests/network/lossy_link.h"
#include "tests/network/small_server.h"
#include "tests/support/effort.h"
#include "tests/unit/server/small_world.h"

namespace mortise::test {
namespace {

using mortise::testing::small_world;

constexpr double kPi = 3.14159265358979323846;
constexpr int kUsers = 2;

DdsOptions options_on(int side) {
  DdsOptions options;
  options.domain = 219;
  options.interface = LossyLink::address(side);
  options.server = LossyLink::address(0);
  return options;
}

struct SeenEvent {
  std::uint64_t seq = 0;
  ClashId clash;
  ClashEvent::Kind kind = ClashEvent::Kind::kUnknown;
  bool operator==(const SeenEvent&) const = default;
};
SeenEvent seen(const ClashEvent& event) { return {event.seq, event.clash, event.kind}; }

/// What both sides write down.
struct Books {
  std::mutex mutex;
  std::map<std::pair<UserId, std::uint64_t>, double> sent_s;
  std::vector<double> took_s;  ///< from sending to the end of the tick that applied it
  std::vector<SeenEvent> events;
  std::uint64_t accepted = 0;
  std::array<std::vector<SeenEvent>, kUsers> seen_events;
  std::array<std::map<PartId, Pose>, kUsers> seen_poses;
  std::uint64_t sent = 0, given_up = 0, resyncs = 0;
  std::atomic<bool> server_open{false}, done{false}, agreed{false};
  std::string fault;
};

void serve(Books& books, World& world, InboxCounters& counters, double& missed) {
  auto channel = open_server_channel(options_on(0));
  if (!channel) {
    books.fault = channel.error().text;
    books.done = true;
    return;
  }
  SystemClock clock;
  TickLoop loop(world, **channel, clock, nullptr, {});
  loop.open();
  loop.run([&] { return books.done.load(); },
           [&] {
             const std::lock_guard lock(books.mutex);
             const double now = now_s();
             for (const Increment& increment : loop.last_intake().increments) {
               ++books.accepted;
               const auto at = books.sent_s.find({increment.user, increment.seq});
               if (at != books.sent_s.end()) books.took_s.push_back(now - at->second);
             }
             for (const ClashEvent& event : loop.last_report().events) {
               books.events.push_back(seen(event));
             }
           });
  counters = loop.inbox().counters();
  missed = static_cast<double>(loop.metrics().missed_deadlines) /
           std::max(1.0, static_cast<double>(loop.metrics().ticks));
}

struct Hand {
  std::unique_ptr<ClientChannel> channel;
  std::unique_ptr<Client> client;
  PartId part;
  double x_mm = 0.0;  ///< away from where it began
};

/// Two designers push their cubes into the wall and pull them out again, 60 times a second.
void act(Books& books, double seconds) {
  std::array<Hand, kUsers> hands;
  for (int i = 0; i < kUsers; ++i) {
    auto channel = open_client_channel(options_on(1));
    if (!channel) {
      books.fault = channel.error().text;
      return;
    }
    hands[i].channel = std::move(*channel);
    hands[i].client = std::make_unique<Client>(*hands[i].channel);
    hands[i].client->add_user("hand" + std::to_string(i), "designer");
    hands[i].part = PartId{static_cast<std::uint32_t>(2 + i)};
  }
  const auto turn = [&] {
    for (int i = 0; i < kUsers; ++i) {
      const ClientUpdate update = hands[i].client->poll();
      books.resyncs += update.resynced;
      for (const ClashEvent& event : update.events) books.seen_events[i].push_back(seen(event));
    }
  };
  const auto all = [&](auto condition) {
    return std::all_of(hands.begin(), hands.end(), condition);
  };
  const auto holder = [](const Hand& hand) {
    return hand.client->parts().at(hand.part).info.holder;
  };
  if (!until(
          15.0,
          [&] {
            return all([](const Hand& h) { return h.client->synced() && h.client->user_id(0); });
          },
          turn)) {
    books.fault = "nobody joined in 15 s";
    return;
  }
  for (Hand& hand : hands) hand.client->grab(0, hand.part);
  if (!until(
          10.0,
          [&] { return all([&](const Hand& h) { return holder(h) == h.client->user_id(0); }); },
          turn)) {
    books.fault = "nobody grabbed in 10 s";
    return;
  }
  const double start_s = now_s();
  for (int beat = 1; now_s() - start_s < seconds; ++beat) {
    for (Hand& hand : hands) {
      const double side = hand.part == PartId{2} ? -1.0 : 1.0;  // towards the wall
      const double x_mm = side * 7.0 * (1.0 - std::cos(2.0 * kPi * beat / 90.0));
      const std::lock_guard lock(books.mutex);
      const double now = now_s();
      const std::uint64_t seq = hand.client->send(0, hand.part, Vec3(x_mm - hand.x_mm, 0, 0));
      books.sent_s[{hand.client->user_id(0), seq}] = now;
      hand.x_mm = x_mm;
      ++books.sent;
    }
    until(
        1.0, [&] { return now_s() - start_s >= beat / 60.0; }, turn);
  }
  // All that was sent is there, and all that came of it is known here.
  books.agreed = until(
      10.0,
      [&] {
        const std::lock_guard lock(books.mutex);
        return books.accepted == books.sent && all([&](const Hand& h) {
                 return h.client->statistics().highest_event_seq ==
                        (books.events.empty() ? 0 : books.events.back().seq);
               });
      },
      turn);
  until(
      3.0, [] { return false; }, turn);  // keyframes repair lost poses
  for (int i = 0; i < kUsers; ++i) {
    books.given_up += hands[i].client->statistics().increments_given_up;
    for (const auto& [id, part] : hands[i].client->parts()) {
      books.seen_poses[i][id] = part.info.X_WP;
    }
  }
}

void play(const LinkSettings& settings) {
  auto link = LossyLink::open(settings);
  if (!link) GTEST_SKIP() << "no lossy link here: " << link.error().text;
  Books books;
  World world = small_world();
  world.policy = Policy::kReport;
  InboxCounters counters;
  double missed = 0.0;
  std::thread server = (*link)->on_side(0, [&] { serve(books, world, counters, missed); });
  std::thread clients = (*link)->on_side(1, [&] {
    act(books, 2.0 * effort(1));
    books.done = true;
  });
  clients.join();
  server.join();
  ASSERT_EQ(books.fault, "");

  std::sort(books.took_s.begin(), books.took_s.end());
  ASSERT_GT(books.took_s.size(), 100u);
  const auto percentile_ms = [&](double p) {
    return 1e3 *
           books.took_s[static_cast<std::size_t>(p * static_cast<double>(books.took_s.size() - 1))];
  };
  const double target_ms = 2e3 * (settings.delay_s + settings.jitter_s) + 1e3 / world.tick_rate_hz;
  std::printf(
      "loss %4.1f %%, delay %3.0f ms, doubled %2.0f %%, jitter %2.0f ms: increment to applied p50 "
      "%.1f p99 %.1f max %.1f ms (target p99 %.1f: %s); sent %llu, repaired %llu, lost %llu, "
      "events %zu, packets %llu (lost %llu), deadlines missed %.2f %%\n",
      100 * settings.loss, 1e3 * settings.delay_s, 100 * settings.duplicate,
      1e3 * settings.jitter_s, percentile_ms(0.5), percentile_ms(0.99), percentile_ms(1.0),
      target_ms, percentile_ms(0.99) <= target_ms ? "held" : "MISSED",
      static_cast<unsigned long long>(books.sent),
      static_cast<unsigned long long>(counters.repaired),
      static_cast<unsigned long long>(counters.lost), books.events.size(),
      static_cast<unsigned long long>((*link)->carried()),
      static_cast<unsigned long long>((*link)->lost()), 100 * missed);
  std::fflush(stdout);

  // The link did what was asked for, or nothing is shown.
  EXPECT_GE(percentile_ms(0.0), 1e3 * settings.delay_s);
  if (settings.loss > 0.0) {
    EXPECT_GT((*link)->lost(), 0u);
  }
  // Nothing is lost, and all know the same.
  EXPECT_TRUE(books.agreed) << "accepted " << books.accepted << " of " << books.sent;
  EXPECT_EQ(counters.accepted, books.sent);
  EXPECT_EQ(counters.lost + books.given_up, 0u);
  EXPECT_EQ(counters.refused_in_all(), 0u);
  ASSERT_GE(books.events.size(), 2u) << "no clash, nothing to agree on";
  for (int i = 0; i < kUsers; ++i) {
    if (books.resyncs == kUsers) {  // the first snapshot of each, and no other
      EXPECT_EQ(books.seen_events[i], books.events) << "user " << i;
    }
    for (const Part& part : world.parts) {
      EXPECT_TRUE(identical(books.seen_poses[i].at(part.id), part.X_WP)) << part.name;
    }
  }
}

TEST(LossyLink, OnePercent20ms) { play({.loss = 0.01, .delay_s = 0.02}); }
TEST(LossyLink, FivePercent20ms) { play({.loss = 0.05, .delay_s = 0.02, .seed = 2}); }
TEST(LossyLink, TenPercent20ms) { play({.loss = 0.10, .delay_s = 0.02, .seed = 3}); }
TEST(LossyLink, FivePercent100ms) { play({.loss = 0.05, .delay_s = 0.1, .seed = 4}); }
TEST(LossyLink, DoubledAndReordered) {
  play({.loss = 0.02, .duplicate = 0.2, .delay_s = 0.02, .jitter_s = 0.03, .seed = 5});
}

}  // namespace
}  // namespace mortise::test
