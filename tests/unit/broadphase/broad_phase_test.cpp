#include "common/broadphase/broad_phase.h"

#include <gtest/gtest.h>

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
