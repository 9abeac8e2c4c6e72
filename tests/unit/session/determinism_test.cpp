// Same world, same increments, same build: the same report bit for bit, however it was worked out.
#include <gtest/gtest.h>

#include "common/session/world/ready_world.h"
#include "tests/unit/session/random_play.h"

namespace mortise {
namespace {

struct Way {
  int threads = 1;
  bool known_distances = true;
  bool brute_force_pairs = false;
  bool made_ready = false;
};

struct Record {
  std::vector<std::uint64_t> digests;
  StepCounters sum;
  std::uint64_t events = 0;
};

Record record(Policy policy, std::uint64_t seed, bool bands, const Way& way) {
  RandomPlay play(policy, seed, 8, bands);
  Scratch scratch(way.threads);
  if (way.made_ready) make_world_ready(play.session.world, way.threads);
  scratch.impl().switches.known_distances = way.known_distances;
  scratch.impl().switches.brute_force_pairs = way.brute_force_pairs;
  Record result;
  for (int i = 0; i < 30; ++i) {
    const StepReport report = play.tick(scratch);
    result.digests.push_back(digest(report));
    result.events += report.events.size();
    result.sum.pairs_budget += report.counters.pairs_budget;
    result.sum.first_contact_queries += report.counters.first_contact_queries;
    result.sum.stopped_parts += report.counters.stopped_parts;
  }
  return result;
}

struct Setting {
  Policy policy;
  bool bands;
};

class Determinism : public ::testing::TestWithParam<Setting> {};

TEST_P(Determinism, ThreadsTreeAndBudgetChangeNothing) {
  const auto [policy, bands] = GetParam();
  for (const std::uint64_t seed : {1, 2}) {
    const Record one = record(policy, seed, bands, {});
    EXPECT_GT(one.events, 5U);
    EXPECT_EQ(record(policy, seed, bands, {}).digests, one.digests) << "again";
    EXPECT_EQ(record(policy, seed, bands, {.threads = 2}).digests, one.digests);
    EXPECT_EQ(record(policy, seed, bands, {.threads = 4}).digests, one.digests);
    EXPECT_EQ(record(policy, seed, bands, {.brute_force_pairs = true}).digests, one.digests);
    EXPECT_EQ(record(policy, seed, bands, {.threads = 2, .made_ready = true}).digests, one.digests);
    const Record plain = record(policy, seed, bands, {.known_distances = false});
    EXPECT_EQ(plain.digests, one.digests) << "known distances";
    EXPECT_EQ(plain.sum.pairs_budget, 0U);
    EXPECT_GT(one.sum.pairs_budget, 0U);
    EXPECT_LT(one.sum.first_contact_queries, plain.sum.first_contact_queries);
    if (policy == Policy::kStop) {
      EXPECT_GT(one.sum.stopped_parts, 0U);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Policies, Determinism,
                         ::testing::Values(Setting{Policy::kReport, false},
                                           Setting{Policy::kReport, true},
                                           Setting{Policy::kStop, false},
                                           Setting{Policy::kStop, true},
                                           Setting{Policy::kSlide, false},
                                           Setting{Policy::kSlide, true}));

// Who is pushed on where it is held stays there by one look at the place that held it; a search
// says the same.
TEST(HeldPlaces, ASearchHoldsWhoIsHeldByItsPlace) {
  struct Pushed {
    std::vector<std::uint64_t> digests;
    std::uint64_t held = 0, evaluations = 0;
  };
  const auto push_down = [](std::uint64_t seed, bool held_places) {
    RandomPlay play(Policy::kStop, seed, 4, true);
    Scratch scratch;
    scratch.impl().switches.work_budget = false;
    scratch.impl().switches.held_places = held_places;
    Pushed pushed;
    for (int i = 0; i < 25; ++i) {
      std::vector<Increment> increments;
      for (const PartId part : play.movers)
        increments.push_back(
            play.session.push(play.user_of(part), part, Vec3(0, 0, -0.6) + 0.1 * play.any()));
      const StepReport report = play_tick(play.session.world, increments, scratch);
      pushed.digests.push_back(digest(report));
      pushed.held += report.counters.pairs_held_again;
      pushed.evaluations += report.counters.depth_evaluations;
    }
    return pushed;
  };
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Pushed with = push_down(seed, true), without = push_down(seed, false);
    EXPECT_EQ(with.digests, without.digests) << seed;
    EXPECT_GT(with.held, 5U) << seed;
    EXPECT_LT(with.evaluations, without.evaluations) << seed;
  }
}

// The comparison must be able to fail.
TEST(DeterminismCheck, OneBitOfOneIncrementIsNoticed) {
  Scratch scratch;
  RandomPlay one(Policy::kReport, 5, 8, false), other(Policy::kReport, 5, 8, false);
  bool differed = false;
  for (int i = 0; i < 20; ++i) {
    auto pushes = one.pushes();
    const StepReport expected = play_tick(one.session.world, pushes, scratch);
    if (i == 7 && !pushes.empty()) pushes[0].translation_mm.x() += 1e-12;
    other.pushes();
    const StepReport got = play_tick(other.session.world, pushes, scratch);
    if (i < 7) {
      EXPECT_EQ(digest(expected), digest(got));
    }
    differed = differed || digest(expected) != digest(got);
  }
  EXPECT_TRUE(differed);
}

// A budget that promises more than was measured is found out by the twin without a budget.
TEST(DeterminismCheck, LyingBudgetIsNoticed) {
  const auto contacts = [](bool lie) {
    SessionBuilder session(Policy::kReport);
    const UserId ada = session.join("ada");
    session.add("wall", cube_mesh(2), at(0, 0, 0), false);
    const PartId peg = session.add("peg", cube_mesh(2), at(-3, 0, 0), true);
    session.grab(ada, peg);
    Scratch scratch;
    play_tick(session.world, {session.push(ada, peg, Vec3(0.1, 0, 0))}, scratch);
    if (lie) session.world.state->memo(0, 1).apart_mm += 10.0;
    return play_tick(session.world, {session.push(ada, peg, Vec3(1.5, 0, 0))}, scratch)
        .events.size();
  };
  EXPECT_EQ(contacts(false), 1U);
  EXPECT_EQ(contacts(true), 0U);
}

// Whoever joins late and follows the stream knows what the session knows.
TEST(EventStream, SnapshotAndLaterEventsGiveTheOpenClashes) {
  for (const Policy policy : {Policy::kReport, Policy::kStop}) {
    RandomPlay play(policy, 11, 8, true);
    Scratch scratch;
    for (int i = 0; i < 30; ++i) play.tick(scratch);
    Snapshot known = snapshot_of(play.session.world);
    std::uint64_t seq = known.event_seq;
    for (int i = 0; i < 40; ++i) {
      for (const ClashEvent& event : play.tick(scratch).events) {
        ASSERT_EQ(event.seq, ++seq);
        std::erase_if(known.open_clashes,
                      [&](const ClashEvent& open) { return open.clash == event.clash; });
        if (event.kind != ClashEvent::Kind::kEnd) known.open_clashes.push_back(event);
      }
    }
    const Snapshot now = snapshot_of(play.session.world);
    EXPECT_EQ(now.event_seq, seq);
    std::sort(known.open_clashes.begin(), known.open_clashes.end(),
              [](const ClashEvent& x, const ClashEvent& y) { return x.clash < y.clash; });
    ASSERT_EQ(known.open_clashes.size(), now.open_clashes.size());
    for (std::size_t i = 0; i < now.open_clashes.size(); ++i) {
      EXPECT_EQ(known.open_clashes[i].clash, now.open_clashes[i].clash);
      EXPECT_EQ(known.open_clashes[i].seq, now.open_clashes[i].seq);
      EXPECT_EQ(known.open_clashes[i].verdict.collision_class,
                now.open_clashes[i].verdict.collision_class);
    }
  }
}

}  // namespace
}  // namespace mortise
