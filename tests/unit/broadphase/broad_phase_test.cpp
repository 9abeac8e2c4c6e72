#include "common/broadphase/broad_phase.h"
#include "common/broadphase/brute_force.h"
#include "common/broadphase/dynamic_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace mortise {
namespace {

Box random_box(std::mt19937_64& rng, double world_mm) {
  std::uniform_real_distribution<double> place(-world_mm, world_mm), size(0.0, 0.2 * world_mm);
  Box box;
  const Vec3 corner(place(rng), place(rng), place(rng));
  box.add(corner);
  box.add(corner + Vec3(size(rng), size(rng), size(rng)));
  return box;
}

TEST(BroadPhase, TreeAgreesWithBruteForceOverManyTicks) {
  for (const double world_mm : {1e-3, 100.0, 1e6}) {
    std::mt19937_64 rng(7);
    const auto tree = make_dynamic_tree(), twin = make_brute_force();
    const std::uint32_t n = 120;
    for (std::uint32_t i = 0; i < n; ++i) {
      const Box box = random_box(rng, world_mm);
      tree->set_box(i, box);
      twin->set_box(i, box);
    }
    std::vector<IndexPair> found, expected;
    std::uint64_t total = 0;
    for (int tick = 0; tick < 200; ++tick) {
      std::vector<std::uint32_t> moved;
      for (std::uint32_t i = 0; i < n; ++i)
        if (rng() % 10 == 0) moved.push_back(i);
      for (const std::uint32_t i : moved) {
        const Box box = random_box(rng, world_mm);
        tree->set_box(i, box);
        twin->set_box(i, box);
      }
      tree->find_pairs(moved, found);
      twin->find_pairs(moved, expected);
      ASSERT_EQ(found, expected) << "tick " << tick;
      EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
      total += found.size();
    }
    EXPECT_GT(total, 100U);
  }
}

// Sessions as they are: most parts stand, some creep, some run, one jumps now and then; parts come
// late, go (an empty box) and come back; sizes from a point to half the world; whoever is asked for
// changes from tick to tick.
struct Crowd {
  std::mt19937_64 rng;
  double world_mm, offset_mm;
  std::vector<Box> boxes;
  std::vector<Vec3> step_mm;

  double u(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(rng); }
  Vec3 any(double size) {
    const double x = u(-size, size), y = u(-size, size), z = u(-size, size);
    return {x, y, z};
  }
  Box fresh() {
    Box box;
    const Vec3 corner = Vec3(offset_mm, -offset_mm, 0.5 * offset_mm) + any(world_mm);
    const double size = world_mm * std::pow(10.0, u(-3.0, 0.0));
    box.add(corner);
    if (rng() % 20 != 0) box.add(corner + any(size));
    return box;
  }
  void add() {
    boxes.push_back(fresh());
    const double speeds[] = {0.0, 1e-4, 1e-2, 0.3};
    step_mm.push_back(any(world_mm * speeds[rng() % 4]));
  }
  // The next box of part i.
  void advance(std::size_t i) {
    Box& box = boxes[i];
    if (box.empty() || rng() % 50 == 0) {
      box = rng() % 10 == 0 ? Box{} : fresh();
      return;
    }
    for (int c = 0; c < 3; ++c)  // bounces off the ends of the world
      if (std::abs(box.lo[c] + step_mm[i][c]) > 1.5 * world_mm + offset_mm) step_mm[i][c] *= -1.0;
    box.lo += step_mm[i];
    box.hi += step_mm[i];
    if (rng() % 10 == 0) box.hi += 0.1 * (box.hi - box.lo);
    if (rng() % 10 == 0) box.hi -= 0.1 * (box.hi - box.lo);
  }
};

TEST(BroadPhase, ListsOfNeighboursAgreeWithBruteForce) {
  struct World {
    double size_mm, offset_mm;
  };
  for (const World world : {World{1e-3, 0.0}, World{100.0, 0.0}, World{100.0, 1e7}, World{1e7, 0.0},
                            World{1e-6, 1e7}}) {
    Crowd crowd{std::mt19937_64(11), world.size_mm, world.offset_mm, {}, {}};
    const auto tree = make_dynamic_tree(), twin = make_brute_force();
    std::vector<IndexPair> found, expected;
    std::uint64_t total = 0;
    for (int tick = 0; tick < 400; ++tick) {
      const std::size_t known = crowd.boxes.size();
      if (tick == 0)
        for (int i = 0; i < 80; ++i) crowd.add();
      else if (tick % 10 == 0)
        crowd.add();
      std::vector<std::uint32_t> moved;
      for (std::uint32_t i = 0; i < crowd.boxes.size(); ++i) {
        const bool is_new = i >= known;
        const bool moves = !is_new && i % 3 == 0 && (tick % 7 != 0 || i % 2 == 0);
        if (moves) crowd.advance(i);
        if (moves || is_new) {
          tree->set_box(i, crowd.boxes[i]);
          twin->set_box(i, crowd.boxes[i]);
        }
        // Asked for without having moved, too; and moved without being asked for.
        if ((moves && crowd.rng() % 8 != 0) || crowd.rng() % 100 == 0) moved.push_back(i);
      }
      tree->find_pairs(moved, found);
      twin->find_pairs(moved, expected);
      ASSERT_EQ(found, expected) << "world " << world.size_mm << " at " << world.offset_mm
                                 << ", tick " << tick;
      total += found.size();
    }
    EXPECT_GT(total, 1000U) << world.size_mm;
  }
}

// Far from the origin a box creeps by steps that FCL takes for no change.
TEST(BroadPhase, CreepingFarAwayIsFollowed) {
  const auto tree = make_dynamic_tree(), twin = make_brute_force();
  const auto point = [](double x_mm) {
    Box box;
    box.add(Vec3(1e7 + x_mm, 0, 0));
    return box;
  };
  std::vector<IndexPair> found, expected;
  int met = 0;
  const auto move = [&](std::uint32_t part, double x_mm) {
    const std::vector<std::uint32_t> moved = {part};
    for (BroadPhase* phase : {tree.get(), twin.get()}) phase->set_box(part, point(x_mm));
    tree->find_pairs(moved, found);
    twin->find_pairs(moved, expected);
    met += static_cast<int>(found.size());
    return found == expected;
  };
  move(1, 1.0);
  for (int step = 0; step <= 30; ++step) {
    ASSERT_TRUE(move(0, 2e-8 * step)) << step;
    ASSERT_TRUE(move(1, 2e-8 * step)) << step;  // another comes there
    ASSERT_TRUE(move(1, 1.0)) << step;          // and leaves again
  }
  EXPECT_GT(met, 5);
}

TEST(BroadPhase, PartWithoutABoxMeetsNobody) {
  for (const auto& make : {make_dynamic_tree, make_brute_force}) {
    const auto phase = make();
    Box a;
    a.add(Vec3(0, 0, 0));
    a.add(Vec3(1, 1, 1));
    phase->set_box(0, a);
    phase->set_box(1, a);
    phase->set_box(2, Box{});
    std::vector<IndexPair> pairs;
    const std::vector<std::uint32_t> moved = {0, 2};
    phase->find_pairs(moved, pairs);
    EXPECT_EQ(pairs, (std::vector<IndexPair>{{0, 1}}));
    phase->set_box(1, Box{});  // gone
    phase->set_box(2, a);      // here at last
    phase->find_pairs(moved, pairs);
    EXPECT_EQ(pairs, (std::vector<IndexPair>{{0, 2}}));
  }
}

TEST(BroadPhaseDeath, NonsenseIsRefused) {
  for (const auto& make : {make_dynamic_tree, make_brute_force}) {
    const auto phase = make();
    Box box;
    box.add(Vec3(0, 0, 0));
    phase->set_box(0, box);
    box.hi.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_DEATH(phase->set_box(1, box), "finite or empty");
    box.hi.x() = std::numeric_limits<double>::infinity();
    EXPECT_DEATH(phase->set_box(1, box), "finite or empty");
    std::vector<IndexPair> pairs;
    const std::vector<std::uint32_t> unknown = {7};
    EXPECT_DEATH(phase->find_pairs(unknown, pairs), "has a box before");
  }
}

TEST(BroadPhase, BoxThatShrankIsNotMetAtItsOldSize) {
  for (const auto& make : {make_dynamic_tree, make_brute_force}) {
    const auto phase = make();
    Box large, small, other;
    large.add(Vec3(0, 0, 0));
    large.add(Vec3(10, 10, 10));
    small.add(Vec3(0, 0, 0));
    small.add(Vec3(1, 1, 1));
    other.add(Vec3(5, 5, 5));
    other.add(Vec3(6, 6, 6));
    phase->set_box(0, large);
    phase->set_box(1, other);
    const std::vector<std::uint32_t> moved = {1};
    std::vector<IndexPair> pairs;
    phase->find_pairs(moved, pairs);
    EXPECT_EQ(pairs, (std::vector<IndexPair>{{0, 1}}));
    phase->set_box(0, small);
    phase->find_pairs(moved, pairs);
    EXPECT_TRUE(pairs.empty());
  }
}

TEST(BroadPhase, TouchingBoxesAreCandidates) {
  for (const auto& make : {make_dynamic_tree, make_brute_force}) {
    const auto phase = make();
    Box a, b;
    a.add(Vec3(0, 0, 0));
    a.add(Vec3(1, 1, 1));
    b.add(Vec3(1, 1, 1));
    b.add(Vec3(2, 2, 2));
    phase->set_box(0, a);
    phase->set_box(1, b);
    std::vector<IndexPair> pairs;
    const std::vector<std::uint32_t> moved = {0, 1};
    phase->find_pairs(moved, pairs);
    EXPECT_EQ(pairs, (std::vector<IndexPair>{{0, 1}}));
  }
}

// The comparison above must be able to fail: a broad phase that forgets one part is found out.
TEST(BroadPhase, ForgottenUpdateIsNoticed) {
  std::mt19937_64 rng(3);
  const auto tree = make_dynamic_tree(), twin = make_brute_force();
  for (std::uint32_t i = 0; i < 60; ++i) {
    const Box box = random_box(rng, 10.0);
    twin->set_box(i, box);
    tree->set_box(i, box);
  }
  std::vector<IndexPair> found, expected;
  bool differed = false;
  for (std::uint32_t i = 0; i < 60; ++i) {
    twin->set_box(i, random_box(rng, 10.0));  // the tree is not told
    const std::vector<std::uint32_t> moved = {i};
    tree->find_pairs(moved, found);
    twin->find_pairs(moved, expected);
    differed = differed || found != expected;
  }
  EXPECT_TRUE(differed);
}

}  // namespace
}  // namespace mortise
