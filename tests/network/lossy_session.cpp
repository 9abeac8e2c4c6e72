#include "tests/network/lossy_session.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "client/client.h"
#include "idl/dds_channel.h"
#include "server/tick_loop.h"
#include "tests/network/small_server.h"
#include "tests/support/numbers.h"
#include "tests/unit/server/small_world.h"

namespace mortise::test {
namespace {

using mortise::testing::small_world;

constexpr int kUsers = LossyRun::kUsers;

DdsOptions options_on(int side) {
  DdsOptions options;
  options.domain = 219;
  options.interface = LossyLink::address(side);
  options.server = LossyLink::address(0);
  return options;
}

SeenEvent seen(const ClashEvent& event) { return {event.seq, event.clash, event.kind}; }

/// What both sides write down.
struct Books {
  std::mutex mutex;
  std::map<std::pair<UserId, std::uint64_t>, double> sent_s;
  std::uint64_t accepted = 0;
  std::atomic<bool> done{false}, closed{false};  ///< no more is asked; no more is answered
  std::string fault;
  LossyRun run;
};

void serve(Books& books) {
  World world = small_world();
  world.policy = Policy::kReport;
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
               if (at != books.sent_s.end()) books.run.took_s.push_back(now - at->second);
             }
             for (const ClashEvent& event : loop.last_report().events) {
               books.run.events.push_back(seen(event));
             }
           });
  books.run.inbox = loop.inbox().counters();
  books.run.known = knowledge_of(snapshot_of(world));
  books.run.target_s = 1.0 / world.tick_rate_hz;
  books.run.missed = static_cast<double>(loop.metrics().missed_deadlines) /
                     std::max(1.0, static_cast<double>(loop.metrics().ticks));
  books.closed = true;
}

struct Mover {
  std::unique_ptr<ClientChannel> channel;
  std::unique_ptr<Client> client;
  PartId part;
  double x_mm = 0.0;  ///< away from where it began
};

/// Two designers push their cubes into the wall and pull them out again, 60 times a second.
void act(Books& books, double seconds) {
  std::array<Mover, kUsers> hands;
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
      books.run.resyncs += update.resynced;
      for (const ClashEvent& event : update.events) books.run.seen_events[i].push_back(seen(event));
    }
  };
  const auto all = [&](auto condition) {
    return std::all_of(hands.begin(), hands.end(), condition);
  };
  const auto holder = [](const Mover& hand) {
    return hand.client->parts().at(hand.part).info.holder;
  };
  if (!until(
          15.0,
          [&] {
            return all([](const Mover& h) { return h.client->synced() && h.client->user_id(0); });
          },
          turn)) {
    books.fault = "nobody joined in 15 s";
    return;
  }
  for (Mover& hand : hands) hand.client->grab(0, hand.part);
  if (!until(
          10.0,
          [&] { return all([&](const Mover& h) { return holder(h) == h.client->user_id(0); }); },
          turn)) {
    books.fault = "nobody grabbed in 10 s";
    return;
  }
  const double start_s = now_s();
  for (int beat = 1; now_s() - start_s < seconds; ++beat) {
    for (Mover& hand : hands) {
      const double side = hand.part == PartId{2} ? -1.0 : 1.0;  // towards the wall
      const double x_mm = side * 7.0 * (1.0 - std::cos(2.0 * kPi * beat / 90.0));
      const std::lock_guard lock(books.mutex);
      const double now = now_s();
      const std::uint64_t seq = hand.client->send(0, hand.part, Vec3(x_mm - hand.x_mm, 0, 0));
      books.sent_s[{hand.client->user_id(0), seq}] = now;
      hand.x_mm = x_mm;
      ++books.run.sent;
    }
    until(
        1.0, [&] { return now_s() - start_s >= beat / 60.0; }, turn);
  }
  // All that was sent is there, and all that came of it is known here.
  books.run.agreed = until(
      10.0,
      [&] {
        const std::lock_guard lock(books.mutex);
        return books.accepted == books.run.sent && all([&](const Mover& h) {
                 return h.client->statistics().highest_event_seq ==
                        (books.run.events.empty() ? 0 : books.run.events.back().seq);
               });
      },
      turn);
  until(
      3.0, [] { return false; }, turn);  // keyframes repair lost poses
  for (int i = 0; i < kUsers; ++i) {
    books.run.given_up += hands[i].client->statistics().increments_given_up;
    books.run.seen[i] = knowledge_of(*hands[i].client);
  }
  // Who leaves lets go: not before the server has said what it knows.
  books.done = true;
  until(
      2.0, [&] { return books.closed.load(); }, [] {});
}

}  // namespace

Result<LossyRun> play_across(const LinkSettings& settings, double seconds) {
  auto link = LossyLink::open(settings);
  if (!link) return link.error();
  Books books;
  std::thread server = (*link)->on_side(0, [&] { serve(books); });
  std::thread clients = (*link)->on_side(1, [&] {
    act(books, seconds);
    books.done = true;
  });
  clients.join();
  server.join();
  if (!books.fault.empty()) return fail(Code::kRuntime, books.fault);
  LossyRun& run = books.run;
  std::sort(run.took_s.begin(), run.took_s.end());
  run.target_s += 2.0 * (settings.delay_s + settings.jitter_s);
  run.carried = (*link)->carried();
  run.lost = (*link)->lost();
  return std::move(run);
}

}  // namespace mortise::test
