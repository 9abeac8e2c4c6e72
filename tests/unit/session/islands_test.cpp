// What has nothing to do with each other responds side by side, as it would all together.
#include "common/session/tick/islands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "tests/unit/session/random_play.h"

namespace mortise {
namespace {

// Every move is in one island, with all moves that it is joined to: by marks that spread until
// nothing changes.
TEST(Islands, AreWhatPairsAndGroupsJoin) {
  std::mt19937_64 rng(3);
  Islands islands;
  for (int run = 0; run < 200; ++run) {
    const auto count = static_cast<std::int32_t>(1 + rng() % 30);
    std::vector<Move> moves(static_cast<std::size_t>(count));
    for (Move& move : moves)
      if (rng() % 4 == 0) move.group = GroupId{static_cast<std::uint32_t>(1 + rng() % 3)};
    std::vector<PairWork> pairs(rng() % 20);
    const auto any = [&] { return static_cast<std::int32_t>(rng() % (count + 1)) - 1; };
    for (PairWork& pair : pairs) {
      pair.ids.move_a = any();
      pair.ids.move_b = any();
    }
    std::vector<std::int32_t> mark(moves.size());
    for (std::int32_t i = 0; i < count; ++i) mark[static_cast<std::size_t>(i)] = i;
    for (bool changed = true; changed;) {
      changed = false;
      const auto join = [&](std::int32_t x, std::int32_t y) {
        std::int32_t &m = mark[static_cast<std::size_t>(x)], &n = mark[static_cast<std::size_t>(y)];
        changed |= m != n;
        m = n = std::min(m, n);
      };
      for (const PairWork& pair : pairs)
        if (pair.ids.move_a >= 0 && pair.ids.move_b >= 0) join(pair.ids.move_a, pair.ids.move_b);
      for (std::int32_t x = 0; x < count; ++x)
        for (std::int32_t y = 0; y < x; ++y)
          if (const GroupId group = moves[static_cast<std::size_t>(x)].group;
              group && group == moves[static_cast<std::size_t>(y)].group)
            join(x, y);
    }

    islands.find(moves, pairs, false);
    EXPECT_EQ(islands.size(), std::set(mark.begin(), mark.end()).size());
    std::size_t seen_moves = 0, seen_pairs = 0;
    for (std::size_t i = 0; i < islands.size(); ++i) {
      const Island& island = islands[i];
      seen_moves += island.moves.size();
      seen_pairs += island.pairs.size();
      ASSERT_FALSE(island.moves.empty());
      EXPECT_TRUE(std::is_sorted(island.moves.begin(), island.moves.end()));
      for (const std::int32_t move : island.moves)
        EXPECT_EQ(mark[static_cast<std::size_t>(move)], island.moves.front());
      for (const std::uint32_t at : island.pairs)
        for (const std::int32_t move : {pairs[at].ids.move_a, pairs[at].ids.move_b})
          EXPECT_TRUE(move < 0 || std::count(island.moves.begin(), island.moves.end(), move) == 1);
    }
    EXPECT_EQ(seen_moves, moves.size());
    EXPECT_EQ(seen_pairs, static_cast<std::size_t>(
                              std::count_if(pairs.begin(), pairs.end(), [](const PairWork& pair) {
                                return pair.ids.move_a >= 0 || pair.ids.move_b >= 0;
                              })));
    islands.find(moves, pairs, true);
    EXPECT_EQ(islands.size(), 1U);
  }
}

// Fields far from each other: in each a post, and three boxes about it that are pushed into it and
// into each other.
struct Fields {
  SessionBuilder session;
  UserId ada;
  std::vector<PartId> boxes;
  std::mt19937_64 rng{7};
  Scratch scratch;

  Fields(Policy policy, bool bands, bool islands, int threads) : session(policy), scratch(threads) {
    scratch.impl().switches.islands = islands;
    scratch.impl().switches.work_budget = false;
    ada = session.join("ada");
    for (int field = 0; field < 6; ++field) {
      const double x = 100.0 * field;
      session.add("post", box_mesh(Vec3(-2, -2, -9), Vec3(2, 2, 9)), at(x, 0, 0), false);
      for (int i = 0; i < 3; ++i) {
        boxes.push_back(session.add("box", box_mesh(Vec3(-2, -2, -2), Vec3(2, 2, 2)),
                                    at(x + 5.0 * (i - 1), i == 1 ? 5 : 0.3 * field, 0), true));
        if (bands) session.set_tolerance(boxes.back(), 0.02);
        session.grab(ada, boxes.back());
      }
    }
  }

  double u() { return std::uniform_real_distribution<double>(-1.0, 1.0)(rng); }
  StepReport tick() {
    std::vector<Increment> increments;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Vec3 to_post =
          Vec3(100.0 * static_cast<double>(i / 3), 0, 0) - session.world.find(boxes[i])->X_WP.p;
      const double x = u(), y = u(), z = u(), turn = u();
      increments.push_back(
          session.push(ada, boxes[i], Vec3(x, y, 0.2 * z) + 0.2 * to_post,
                       turn > 0.3 ? Vec3(0, 0.02 * turn, 0.05 * z) : Vec3::Zero()));
    }
    return play_tick(session.world, increments, scratch);
  }
};

struct Played {
  std::vector<std::uint64_t> digests;
  std::uint64_t stopped = 0, legs = 0, rounds = 0;
};

Played play_fields(Policy policy, bool bands, bool islands, int threads) {
  Fields fields(policy, bands, islands, threads);
  Played played;
  for (int i = 0; i < 12; ++i) {
    const StepReport report = fields.tick();
    played.digests.push_back(digest(report));
    played.stopped += report.counters.stopped_parts;
    played.legs += report.counters.slide_legs;
    played.rounds += report.counters.rounds;
  }
  return played;
}

TEST(Islands, SideBySideIsAsAllTogether) {
  for (const Policy policy : {Policy::kStop, Policy::kSlide})
    for (const bool bands : {false, true}) {
      const Played together = play_fields(policy, bands, false, 1);
      EXPECT_GT(together.stopped, 5U) << "nothing is shown";
      EXPECT_EQ(together.legs > 10, policy == Policy::kSlide) << "nothing is shown";
      for (const int threads : {1, 3}) {
        const Played apart = play_fields(policy, bands, true, threads);
        EXPECT_EQ(apart.digests, together.digests) << static_cast<int>(policy) << bands << threads;
        EXPECT_EQ(apart.legs, together.legs);
        EXPECT_LT(apart.rounds, together.rounds) << "one after the other";
      }
    }
}

}  // namespace
}  // namespace mortise
