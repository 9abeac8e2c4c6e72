// A hand's increments through a bad link: the sender's repetition and the receiver's order together
// lose nothing, double nothing, and keep the order.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>

#include "client/unacknowledged.h"
#include "server/increment_order.h"
#include "tests/support/effort.h"

namespace mortise::test {
namespace {

struct LinkFaults {
  double loss = 0.0, duplicate = 0.0;
  int delay = 0, jitter = 0;          ///< turns; jitter lets datagrams overtake each other
  int down_from = 0, down_until = 0;  ///< turns in which nothing passes
};

template <class Datagram>
class Link {
 public:
  Link(const LinkFaults& faults, std::mt19937_64& random) : faults_(faults), random_(random) {}
  void send(const Datagram& datagram, int now) {
    if (now >= faults_.down_from && now < faults_.down_until) return;
    std::uniform_real_distribution<double> chance(0.0, 1.0);
    for (int copy = chance(random_) < faults_.duplicate ? 2 : 1; copy > 0; --copy) {
      if (chance(random_) < faults_.loss) continue;
      const int jitter =
          faults_.jitter > 0 ? static_cast<int>(random_() % (faults_.jitter + 1)) : 0;
      under_way_.push_back({now + faults_.delay + jitter, datagram});
    }
  }
  std::vector<Datagram> receive(int now) {
    std::vector<Datagram> due;
    std::erase_if(under_way_, [&](const auto& entry) {
      if (entry.first > now) return false;
      due.push_back(entry.second);
      return true;
    });
    return due;
  }

 private:
  LinkFaults faults_;
  std::mt19937_64& random_;
  std::vector<std::pair<int, Datagram>> under_way_;
};

struct Outcome {
  std::uint64_t sent = 0, handed_out = 0, repaired = 0, lost = 0, given_up = 0;
  std::vector<int> age;  ///< turns from sending to handing out
  bool in_order = true;
};

void take_all(IncrementOrder& order, std::vector<ReceivedIncrement>& ready) {
  while (order.next() != nullptr) ready.push_back(order.take_next());
}

/// One turn is one period of the sender. A hand that moves, rests and moves again.
Outcome play(const LinkFaults& faults, int turns, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Link<IncrementBatch> up(faults, random);
  Link<std::uint64_t> down(faults, random);
  Unacknowledged sender;
  IncrementOrder order;
  Outcome outcome;
  std::uint64_t last = 0;
  const int quiet = 400;
  for (int now = 0; now < turns + quiet; ++now) {
    if (now < turns && now / 50 % 4 != 3) {
      SentIncrement sent;
      sent.increment.seq = ++outcome.sent;
      sent.sent_ns = now;
      const IncrementBatch batch = sender.add(sent, now);
      EXPECT_LE(batch.increments.size(), kMaxBatchIncrements);
      EXPECT_EQ(batch.increments.back().increment.seq, outcome.sent);
      up.send(batch, now);
    } else if (!sender.empty() && now - sender.last_sent_ns() >= 3) {
      up.send(sender.repeat(now), now);
    }
    std::vector<ReceivedIncrement> ready;
    for (const IncrementBatch& batch : up.receive(now)) {
      for (const auto& [increment, sent_ns] : batch.increments) {
        (void)order.receive({"", increment, sent_ns, batch.kept_from,
                             increment.seq < batch.fresh_from, Refusal::kNone});
        take_all(order, ready);
      }
      down.send(order.newest(), now);
    }
    for (const ReceivedIncrement& r : ready) {
      outcome.in_order &= r.increment.seq > last;
      last = r.increment.seq;
      ++outcome.handed_out;
      outcome.age.push_back(now - static_cast<int>(r.sent_ns));
    }
    for (const std::uint64_t seq : down.receive(now)) sender.acknowledge(seq);
  }
  EXPECT_TRUE(sender.empty());
  EXPECT_EQ(order.held(), 0u);
  outcome.repaired = order.repaired();
  outcome.lost = order.lost();
  outcome.given_up = sender.given_up();
  std::sort(outcome.age.begin(), outcome.age.end());
  return outcome;
}

int percentile(const std::vector<int>& sorted, double p) {
  return sorted[static_cast<std::size_t>(p * static_cast<double>(sorted.size() - 1))];
}

TEST(IncrementLink, LosesDoublesAndSwapsNothing) {
  for (const double loss : {0.0, 0.01, 0.05, 0.1, 0.3}) {
    for (const int delay : {0, 2, 25}) {
      for (int seed = 1; seed <= effort(5); ++seed) {
        const LinkFaults faults{loss, 0.1, delay, seed % 2 == 0 ? 3 : 0, 0, 0};
        const Outcome outcome = play(faults, 3000, static_cast<std::uint64_t>(seed));
        ASSERT_TRUE(outcome.in_order) << "loss " << loss << " delay " << delay << " seed " << seed;
        ASSERT_EQ(outcome.handed_out, outcome.sent);
        ASSERT_EQ(outcome.lost + outcome.given_up, 0u);
        if (loss > 0.0 || faults.jitter == 0) {
          ASSERT_EQ(outcome.repaired > 0, loss > 0.0);
        }
      }
    }
  }
}

TEST(IncrementLink, OneLostDatagramCostsOnePeriod) {
  const Outcome outcome = play({0.05, 0.0, 1, 0, 0, 0}, effort(50'000), 7);
  std::printf("5 %% loss, one period of delay: p50 %d, p99 %d, p99.9 %d periods, repaired %llu\n",
              percentile(outcome.age, 0.5), percentile(outcome.age, 0.99),
              percentile(outcome.age, 0.999), static_cast<unsigned long long>(outcome.repaired));
  EXPECT_EQ(percentile(outcome.age, 0.5), 1);
  EXPECT_LE(percentile(outcome.age, 0.99), 2);
}

TEST(IncrementLink, AnOutageIsMadeGoodAndALongOneIsCounted) {
  // 4 s at 240 Hz, less the pauses of the hand: still kept.
  Outcome outcome = play({0.02, 0.0, 5, 0, 500, 1500}, 3000, 3);
  EXPECT_EQ(outcome.handed_out, outcome.sent);
  EXPECT_EQ(outcome.lost, 0u);
  // Longer than is kept: exactly what the sender gave up is missing.
  outcome = play({0.02, 0.0, 5, 0, 500, 3500}, 5000, 4);
  EXPECT_TRUE(outcome.in_order);
  EXPECT_GT(outcome.given_up, 1000u);
  EXPECT_LE(outcome.lost, outcome.given_up) << "an acknowledgement may be what is missing";
  EXPECT_GT(outcome.lost, 1000u);
  EXPECT_EQ(outcome.handed_out + outcome.lost, outcome.sent);
}

TEST(IncrementOrder, WaitsForNobodyWhoNeverRepeats) {
  IncrementOrder order;
  std::vector<ReceivedIncrement> ready;
  const auto receive = [&](std::uint64_t seq, std::uint64_t kept_from = 0) {
    ReceivedIncrement r;
    r.increment.seq = seq;
    r.kept_from = kept_from;
    const IncrementOrder::Arrival arrival = order.receive(r);
    take_all(order, ready);
    return arrival;
  };
  using Arrival = IncrementOrder::Arrival;
  EXPECT_EQ(receive(5), Arrival::kNew);
  EXPECT_EQ(order.lost(), 0u) << "what was before the first is nobody's loss";
  EXPECT_EQ(receive(9), Arrival::kNew);
  EXPECT_EQ(order.lost(), 3u);
  EXPECT_EQ(receive(9), Arrival::kSeen);
  EXPECT_EQ(receive(7), Arrival::kStale);
  EXPECT_EQ(ready.size(), 2u);
  EXPECT_EQ(receive(12, 10), Arrival::kNew);
  EXPECT_EQ(ready.size(), 2u) << "10 and 11 can still come";
  EXPECT_EQ(receive(11, 11), Arrival::kNew);
  EXPECT_EQ(ready.size(), 4u) << "10 can not come any more";
  EXPECT_EQ(order.lost(), 4u);
  EXPECT_EQ(order.newest(), 12u);
}

TEST(IncrementOrder, ASenderThatFillsNoHoleCostsABoundedMemory) {
  IncrementOrder order;
  std::vector<ReceivedIncrement> ready;
  for (std::uint64_t seq = 3; seq < 10'000; seq += 2) {
    ReceivedIncrement r;
    r.increment.seq = seq;
    r.kept_from = 1;
    (void)order.receive(r);
    take_all(order, ready);
    ASSERT_LE(order.held(), kMaxKeptIncrements);
  }
  EXPECT_GT(order.lost(), 3000u);
  EXPECT_GT(ready.size(), 3000u);
}

TEST(IncrementOrder, WhatIsNotTakenKeepsItsPlaceAndIsBounded) {
  IncrementOrder order;
  const auto receive = [&](std::uint64_t seq) {
    ReceivedIncrement r;
    r.increment.seq = seq;
    r.kept_from = 1;
    r.repeated = true;
    return order.receive(r);
  };
  using Arrival = IncrementOrder::Arrival;
  for (std::uint64_t seq = 1; seq <= kMaxKeptIncrements; ++seq)
    ASSERT_EQ(receive(seq), Arrival::kNew);
  EXPECT_EQ(receive(kMaxKeptIncrements + 1), Arrival::kNoRoom);
  EXPECT_EQ(receive(7), Arrival::kSeen);
  EXPECT_EQ(order.newest(), 0u);
  EXPECT_EQ(order.take_next().increment.seq, 1u);
  EXPECT_EQ(receive(kMaxKeptIncrements + 1), Arrival::kNew);
  std::vector<ReceivedIncrement> ready;
  take_all(order, ready);
  EXPECT_EQ(ready.size(), kMaxKeptIncrements);
  EXPECT_EQ(order.lost(), 0u);
}

}  // namespace
}  // namespace mortise::test
