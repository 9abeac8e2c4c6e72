// Somebody in the session who says what nobody should, as fast as he can, while others work: the
// server goes on, so does the one that stands by, and takes over with all that was acknowledged.
// MORTISE_SOAK_S says for how long.
#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <cstdlib>
#include <random>
#include <thread>

#include "idl/participant.h"
#include "idl/wire_types.h"
#include "server/tick_bytes.h"
#include "tests/network/second_server.h"
#include "tests/support/effort.h"

namespace mortise::test {
namespace {

double rogue_s() {
  const char* seconds = std::getenv("MORTISE_SOAK_S");
  return seconds != nullptr ? std::atof(seconds) : effort(3);
}

using Random = std::mt19937_64;
std::size_t below(Random& random, std::size_t n) { return random() % n; }

/// A number as somebody honest would say it, or one at an end of what can be said.
std::uint64_t some_number(Random& random) {
  switch (below(random, 4)) {
    case 0:
      return below(random, 100);
    case 1:
      return std::uint64_t{1} << below(random, 64);
    case 2:
      return ~std::uint64_t{0} - below(random, 3);
    default:
      return random();
  }
}

class Rogue : public SecondServer {
 protected:
  /// All others act until the time is over; then the first is killed.
  void goes_on_beside(const std::function<void(const std::atomic<bool>& stop)>& rogue_acts) {
    auto [first, second] = both();
    ASSERT_FALSE(HasFailure());
    const int losses = losses_;
    moves_ = true;
    std::atomic<bool> stop{false};
    std::thread rogue([&] { rogue_acts(stop); });
    for (const double end_s = steady_s() + rogue_s(); steady_s() < end_s && !HasFailure();) {
      turn(1.0);
      // Where it is silent for long, a busy machine takes its part.
      if (ben_->client->user_id(0) && ben_->holder("blue") != ben_->client->user_id(0))
        ben_->client->grab(ben_->user, blue_);
      // A machine that gives the first no processor for its lease has the second take over.
      EXPECT_TRUE(first->running() || second->errors().find("taken over") != std::string::npos)
          << first->errors();
      EXPECT_TRUE(second->running()) << second->errors();
    }
    Guest late(domain_, "late", "observer");
    EXPECT_TRUE(wait_until([&] {
      late.listen();
      return late.client->user_id(late.user) && late.client->synced();
    })) << "who comes meanwhile gets in; "
        << first->errors();
    stop = true;
    rogue.join();
    ASSERT_FALSE(HasFailure());
    if (timed()) {
      EXPECT_EQ(losses_, losses) << "nobody has changed servers";
    }
    ASSERT_TRUE(goes_on());
    if (first->running()) {
      first->signal(SIGKILL);
      ASSERT_TRUE(says(*second, "taken over at tick")) << second->errors();
    }
    ASSERT_TRUE(all_in());
    EXPECT_TRUE(goes_on());
    std::printf("%.0f s beside a rogue who said %llu things; %zu increments acknowledged\n",
                rogue_s(), static_cast<unsigned long long>(said_), acknowledged_.size());
    EXPECT_GT(said_, 100U);
    EXPECT_EQ(lost_of_acknowledged(*second), 0U);
  }
  /// Ben's moves are taken; where he has lost his part, he takes it again.
  bool goes_on() {
    const std::size_t before = acknowledged_.size();
    double asked_s = 0.0;
    return wait_until([&] {
      const UserId ben = ben_->client->user_id(0);
      if (ben && ben_->holder("blue") != ben && steady_s() - asked_s > 0.5) {
        ben_->client->grab(ben_->user, blue_);
        asked_s = steady_s();
      }
      return acknowledged_.size() > before + 30;
    });
  }
  std::unique_ptr<Participant> rogue() const {
    DdsOptions options;
    options.domain = domain_;
    auto opened = Participant::open(options, Participant::Side::kClient, nullptr);
    EXPECT_TRUE(opened) << opened.error().text;
    return opened ? std::move(*opened) : nullptr;
  }
  std::uint64_t said_ = 0;
};

std::string some_name(Random& random) {
  switch (below(random, 8)) {
    case 0:
      return "anna";  // who is in
    case 1:
      return "";
    case 2:
      return std::string(below(random, 40'000), 'n');
    case 3:
      return "a\nb\x1b[2J";
    case 4:
      return "\xe2\x80\xae evil";
    case 5:
      return "\xff\xfe\xc0";
    default:
      return "rogue " + std::to_string(below(random, 5000));
  }
}

wire::Request some_request(Random& random) {
  constexpr const char* kRoles[] = {"designer", "observer", "bot", "gateway", "", "root"};
  wire::Request request;
  const std::size_t kind = below(random, 20);
  if (kind < 14) {
    request.join().resize(1);
    request.join()[0].nonce(below(random, 2) == 0 ? random() : below(random, 50));
    request.join()[0].name(some_name(random));
    request.join()[0].role(kRoles[below(random, std::size(kRoles))]);
  } else if (kind < 16) {
    request.leave().resize(1);
    request.leave()[0].user(static_cast<std::uint32_t>(some_number(random)));
  } else if (kind < 19) {
    request.command().resize(1);
    request.command()[0].kind(static_cast<std::uint8_t>(random()));
    request.command()[0].user(static_cast<std::uint32_t>(some_number(random)));
    request.command()[0].part(static_cast<std::uint32_t>(some_number(random)));
    request.command()[0].seq(some_number(random));
    request.command()[0].after(some_number(random));
  } else {
    request.snapshot(true);
  }
  return request;
}

TEST_F(Rogue, AFloodOfJoinsEndsNobody) {
  goes_on_beside([this](const std::atomic<bool>& stop) {
    Random random(31);
    while (!stop) {  // comes, says much, goes; often without the seats that he got
      const auto participant = rogue();
      dds::DataWriter* writer = nullptr;
      Status status = ok();
      participant->open_writer<wire::RequestPubSubType>(Topic::kRequest, writer, status);
      ASSERT_TRUE(status);
      for (int i = 0; i < 8000 && !stop; ++i) {
        wire::Request request = some_request(random);
        said_ += writer->write(&request);
        if (i % 4 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    }
  });
}

wire::ServerTick some_tick(Random& random, std::uint64_t now_ms) {
  wire::ServerTick sample;
  const std::uint64_t terms[] = {0,
                                 now_ms,
                                 now_ms - below(random, 100'000),
                                 now_ms + 1000,
                                 some_number(random),
                                 kLatestTerm_ms,
                                 ~std::uint64_t{0}};
  sample.tick(some_number(random));
  sample.term(terms[below(random, std::size(terms))]);
  sample.count(static_cast<std::uint32_t>(below(random, 2) == 0 ? 1 : some_number(random)));
  sample.chunk(static_cast<std::uint32_t>(below(random, 2) == 0 ? 0 : some_number(random)));
  sample.follower(below(random, 2) == 0 ? "" : std::string(below(random, 30'000), 'a'));
  if (below(random, 2) == 0) {  // one that can be read
    FollowedTick tick;
    tick.tick = sample.tick();
    tick.state_hash = random();
    tick.decisions.push_back({Decision::Kind::kJoin, UserId{1}, {}, "rogue", Role::kDesigner});
    const auto bytes = encode(tick);
    for (const std::byte byte : bytes) sample.bytes().push_back(static_cast<std::uint8_t>(byte));
  } else {
    sample.bytes().resize(below(random, 50'000));
    for (std::uint8_t& byte : sample.bytes()) byte = static_cast<std::uint8_t>(random());
  }
  return sample;
}

/// He leads nothing: nobody believes him what he says of ticks.
TEST_F(Rogue, TicksOfNobodyEndNobody) {
  goes_on_beside([this](const std::atomic<bool>& stop) {
    Random random(32);
    while (!stop) {
      const auto participant = rogue();
      dds::DataWriter *ticks = nullptr, *taken = nullptr;
      Status status = ok();
      participant->open_writer<wire::ServerTickPubSubType>(Topic::kTick, ticks, status);
      participant->open_writer<wire::ServerTakenPubSubType>(Topic::kTaken, taken, status);
      ASSERT_TRUE(status);
      const std::uint64_t now_ms = next_term(0);
      participant->change_term(*ticks, below(random, 2) == 0 ? now_ms : some_number(random));
      for (int i = 0; i < 2000 && !stop; ++i) {
        wire::ServerTick tick = some_tick(random, now_ms);
        said_ += ticks->write(&tick);
        wire::ServerTaken one;
        one.tick(some_number(random));
        one.term(some_number(random));
        one.computed(some_number(random));
        said_ += taken->write(&one);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    }
  });
}

}  // namespace
}  // namespace mortise::test
