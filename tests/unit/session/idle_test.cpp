// A session in which nothing moves: no geometry, no memory.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/unit/session/random_play.h"

namespace {
std::atomic<std::uint64_t> allocations = 0;
}

// A sanitizer has its own; it finds leaks, this counts.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kCounts = false;
#else
constexpr bool kCounts = true;
// Inlined, the compiler takes free() for the wrong partner of the new above it.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"
void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size == 0 ? 1 : size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
#endif

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

// One part moves past neighbours that it does not meet: all that is allocated is the list of poses
// that is told.
TEST(IdleTick, AFreeMoveAllocatesNothingButItsReport) {
  SessionBuilder session = assembly();
  session.world.tick_rate_hz = 60.0;
  Scratch scratch(2);
  play_tick(session.world, {}, scratch);
  std::uint64_t asked = 0;
  for (int i = 0; i < 200; ++i) {
    // Turning beside its neighbour, so that their boxes meet.
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    const std::vector<Increment> increments{
        session.push(UserId{1}, PartId{5}, sign * Vec3(0.5, 0, 0), sign * Vec3(0, 0, 0.7))};
    const std::uint64_t before = allocations;
    const StepReport report = step(session.world, increments, scratch);
    const std::uint64_t allocated = allocations - before;
    EXPECT_EQ(report.moved.size(), 1U);
    ASSERT_EQ(report.counters.contacts.out, 0U) << "it met something: nothing is shown";
    asked += report.counters.pairs.out + report.counters.pairs_budget;
    EXPECT_LE(allocated, i < 20 ? 1000U : 1U) << i;
  }
  EXPECT_GT(asked, 100U) << "no pair was looked at: nothing is shown";
}

// Planted: the counter of allocations counts.
TEST(IdleTick, AllocationsAreCounted) {
  if (!kCounts) GTEST_SKIP() << "sanitizer: allocations are not counted";
  const std::uint64_t before = allocations;
  std::vector<int> v(1000);
  EXPECT_GT(allocations, before) << v.size();
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
