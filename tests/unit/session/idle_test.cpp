// A session in which nothing moves: no geometry, no memory, no time.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <new>

#include "tests/unit/session/random_play.h"

namespace {
std::atomic<std::uint64_t> allocations = 0;
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size == 0 ? 1 : size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace mortise {
namespace {

// 100 parts in a row, half of them moving, a few of them overlapping.
SessionBuilder assembly() {
  SessionBuilder session(Policy::kStop);
  const UserId ada = session.join("ada");
  for (int i = 0; i < 100; ++i) {
    const PartId part = session.add(std::string("part").append(std::to_string(i)), cube_mesh(2),
                                    at(i % 10 ? 3.0 * i : 3.0 * i - 1.5, 0, 0), i % 2 == 0);
    if (i % 2 == 0) session.grab(ada, part);
  }
  return session;
}

TEST(IdleTick, DoesNoGeometryAndAllocatesNothing) {
  SessionBuilder session = assembly();
  Scratch scratch(2);
  const StepReport first = play_tick(session.world, {}, scratch);
  EXPECT_FALSE(first.events.empty());
  for (int i = 0; i < 50; ++i) {
    const std::uint64_t before = allocations;
    const StepReport report = step(session.world, std::span<const Increment>(), scratch);
    EXPECT_EQ(allocations, before) << i;
    const StepCounters& c = report.counters;
    EXPECT_EQ(c.pairs.in, 4950U);
    EXPECT_EQ(c.pairs.in, c.pairs_static + c.pairs_still);
    EXPECT_EQ(c.pairs.out + c.contacts.in + c.first_contact_queries + c.distance_queries +
                  c.depth_queries + c.verdicts.in + c.box_tests + c.triangle_tests +
                  c.depth_evaluations,
              0U);
    EXPECT_TRUE(report.events.empty());
  }
}

// Planted: the counter of allocations counts.
TEST(IdleTick, AllocationsAreCounted) {
  const std::uint64_t before = allocations;
  std::vector<int> v(1000);
  EXPECT_GT(allocations, before) << v.size();
}

TEST(IdleTick, TakesLessThanFiveMicroseconds) {
  SessionBuilder session = assembly();
  Scratch scratch;
  play_tick(session.world, {}, scratch);
  double best_us = 1e9;
  for (int round = 0; round < 50; ++round) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < 100; ++i) step(session.world, std::span<const Increment>(), scratch);
    const std::chrono::duration<double, std::micro> spent =
        std::chrono::steady_clock::now() - start;
    best_us = std::min(best_us, spent.count() / 100.0);
  }
  RecordProperty("best_us", std::to_string(best_us));
  EXPECT_LT(best_us, 5.0);
}

// Only what moves is looked at: one part of 100 asks its neighbours, the others stay out of it.
TEST(IdleTick, OneMoverAsksOnlyItsNeighbours) {
  SessionBuilder session = assembly();
  Scratch scratch;
  play_tick(session.world, {}, scratch);
  const StepReport report =
      play_tick(session.world, {session.push(UserId{1}, PartId{5}, Vec3(0, 0.5, 0))}, scratch);
  const StepCounters& c = report.counters;
  EXPECT_EQ(c.moves.out, 1U);
  EXPECT_EQ(c.pairs_static + c.pairs_still, 4950U - 99U);
  EXPECT_LE(c.pairs.out, 2U);
  EXPECT_EQ(report.moved.size(), 1U);
}

}  // namespace
}  // namespace mortise
