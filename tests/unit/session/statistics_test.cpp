#include "common/session/tick/statistics.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/session/random_play.h"

namespace mortise {
namespace {

using Kind = ClashEvent::Kind;

ClashEvent event(Kind kind, std::uint64_t tick, std::uint32_t clash, CollisionClass now,
                 double depth_mm, CollisionClass worst) {
  ClashEvent e;
  e.kind = kind;
  e.tick = tick;
  e.begin_tick = 1;
  e.clash = ClashId{clash};
  e.part_a = PartId{1};
  e.part_b = PartId{clash + 1};
  e.user = UserId{1};
  e.verdict.collision_class = now;
  e.verdict.delta_mm = {depth_mm, depth_mm};
  e.worst_class = worst;
  return e;
}

StepReport report(std::uint64_t tick, std::vector<ClashEvent> events) {
  StepReport r;
  r.tick = tick;
  r.events = std::move(events);
  return r;
}

TEST(SessionStatistics, CountsByWorstClassAndDurationByClass) {
  using enum CollisionClass;
  SessionStatistics s;
  s.add(report(1, {event(Kind::kBegin, 1, 1, kFake, 0.01, kFake)}));
  s.add(report(2, {}));
  s.add(report(3, {event(Kind::kChange, 3, 1, kReal, 0.5, kReal),
                   event(Kind::kBegin, 3, 2, kPotential, 0.1, kPotential)}));
  s.add(report(4, {}));
  EXPECT_EQ(s.clashes_open(kReal), 1U);
  EXPECT_EQ(s.clashes_open(kPotential), 1U);
  s.add(report(5, {event(Kind::kEnd, 5, 1, kFake, 0.02, kReal)}));
  EXPECT_EQ(s.clashes_open(kReal), 0U);
  EXPECT_EQ(s.clashes_total(kReal), 1U);
  EXPECT_EQ(s.clashes_total(kPotential), 1U);
  EXPECT_EQ(s.clashes_total(kFake), 0U);
  ASSERT_EQ(s.clashes().size(), 2U);
  const auto& first = s.clashes().at(ClashId{1});
  EXPECT_EQ(first.ticks[1], 2U);  // fake in ticks 1, 2
  EXPECT_EQ(first.ticks[3], 2U);  // real in ticks 3, 4
  EXPECT_EQ(first.end_tick, 5U);
  EXPECT_EQ(first.worst.delta_mm.lo, 0.5);
  EXPECT_EQ(s.clashes().at(ClashId{2}).end_tick, 0U);
  const auto& part = s.by_part().at(PartId{1});
  EXPECT_EQ(part.clashes[3], 1U);
  EXPECT_EQ(part.clashes[2], 1U);
  EXPECT_EQ(part.clashes[1], 0U);
  EXPECT_EQ(part.ticks[2], 3U);
  EXPECT_EQ(part.worst_tick, 3U);
  EXPECT_EQ(part.first_tick, 1U);
  EXPECT_EQ(part.last_tick, 5U);
  EXPECT_EQ(s.by_user().at(UserId{1}).clashes[3], 1U);
  EXPECT_EQ(s.by_pair().size(), 2U);
  EXPECT_EQ(s.ticks(), 5U);
}

TEST(SessionStatistics, AgreesWithTheSessionItWasFedFrom) {
  RandomPlay play(Policy::kReport, 4, 8, true);
  Scratch scratch;
  SessionStatistics s;
  StepCounters sum;
  std::uint64_t begins = 0, ends = 0;
  for (int i = 0; i < 60; ++i) {
    const StepReport r = play.tick(scratch);
    s.add(r);
    accumulate(sum, r.counters);
    for (const ClashEvent& e : r.events) {
      begins += e.kind == Kind::kBegin;
      ends += e.kind == Kind::kEnd;
    }
  }
  EXPECT_GT(begins, 0U);
  EXPECT_EQ(s.clashes().size(), begins);
  std::uint64_t open = 0, total = 0;
  for (const CollisionClass c :
       {CollisionClass::kFake, CollisionClass::kPotential, CollisionClass::kReal}) {
    open += s.clashes_open(c);
    total += s.clashes_total(c);
  }
  EXPECT_EQ(total, begins);
  EXPECT_EQ(open, begins - ends);
  EXPECT_EQ(open, snapshot_of(play.session.world).open_clashes.size());
  EXPECT_EQ(s.counters().pairs.in, sum.pairs.in);
  EXPECT_EQ(s.counters().triangle_tests, sum.triangle_tests);
}

// A session of days: rows of what has ended long ago go, counts and sums stay.
TEST(SessionStatistics, KeepsTheRowsThatEndedLast) {
  using enum CollisionClass;
  SessionStatistics all, some;
  some.keep_ended_rows(3);
  std::uint64_t tick = 0;
  for (std::uint32_t id = 1; id <= 10; ++id) {
    // The second never ends; the others are fake or real in turn.
    const CollisionClass c = id % 2 == 0 ? kReal : kFake;
    std::vector<StepReport> told{report(++tick, {event(Kind::kBegin, tick, id, c, 0.1 * id, c)})};
    if (id != 2) told.push_back(report(++tick, {event(Kind::kEnd, tick, id, c, 0.1 * id, c)}));
    for (const StepReport& r : told) {
      all.add(r);
      some.add(r);
    }
  }
  EXPECT_EQ(all.clashes().size(), 10U);
  EXPECT_EQ(all.rows_left_out(), 0U);
  std::vector<std::uint32_t> kept;
  for (const auto& [id, row] : some.clashes()) kept.push_back(id.value);
  EXPECT_EQ(kept, (std::vector<std::uint32_t>{2, 8, 9, 10}));
  EXPECT_EQ(some.rows_left_out(), 6U);
  for (const CollisionClass c : {kFake, kPotential, kReal}) {
    EXPECT_EQ(some.clashes_total(c), all.clashes_total(c));
    EXPECT_EQ(some.clashes_open(c), all.clashes_open(c));
  }
  EXPECT_EQ(some.clashes_open(kReal), 1U);
  EXPECT_EQ(some.by_part().at(PartId{1}).clashes[3], 5U);
  all.keep_ended_rows(3);
  EXPECT_EQ(all.clashes().size(), some.clashes().size());
  EXPECT_TRUE(some.is_whole());
}

// What a damaged log tells: begins and ends twice, ends that nothing began.
TEST(SessionStatistics, TellsApartWhatIsToldTwice) {
  using enum CollisionClass;
  SessionStatistics s;
  s.keep_ended_rows(1);
  std::mt19937 random(7);
  for (std::uint64_t tick = 1; tick < 2000; ++tick) {
    std::vector<ClashEvent> events;
    for (int i = 0; i < 3; ++i)
      events.push_back(event(random() % 2 == 0 ? Kind::kBegin : Kind::kEnd, tick,
                             static_cast<std::uint32_t>(1 + random() % 4), kReal, 0.1, kReal));
    s.add(report(tick, events));
    ASSERT_TRUE(s.is_whole()) << tick;
  }
  EXPECT_GT(s.rows_left_out(), 100U);
}

// accumulate must not forget a field: counters that are all one sum to all two.
TEST(SessionStatistics, AccumulateKnowsEveryCounter) {
  static_assert(sizeof(StepCounters) % sizeof(std::uint64_t) == 0);
  constexpr std::size_t n = sizeof(StepCounters) / sizeof(std::uint64_t);
  StepCounters one, sum;
  auto* words = reinterpret_cast<std::uint64_t*>(&one);
  for (std::size_t i = 0; i < n; ++i) words[i] = 1;
  accumulate(sum, one);
  accumulate(sum, one);
  const auto* summed = reinterpret_cast<const std::uint64_t*>(&sum);
  for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(summed[i], 2U) << "word " << i;
}

}  // namespace
}  // namespace mortise
