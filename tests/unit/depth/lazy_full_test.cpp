// Random pairs of all kinds and grades, lazily and in full: what the lazy answer has decided is the
// same word in full, and where the meshes of a pair that cannot collide overlap both say so.
#include <gtest/gtest.h>

#include <map>

#include "tests/support/effort.h"
#include "tests/unit/depth/mixed_pairs.h"

namespace mortise {
namespace {

TEST(LazyAndFull, DifferOnlyWherePotentialIsDecided) {
  cover_parts::Random random(2026);
  std::map<CollisionClass, int> found;
  int narrowed = 0;
  for (int i = 0; i < test::effort(70); ++i) {
    OverlapCase c = mixed::any_case(random, i);
    c.refinement = Refinement::kDecided;
    const CollisionClass lazy = worst_class(overlap_of(c));
    c.refinement = Refinement::kFull;
    const CollisionClass full = worst_class(overlap_of(c));
    ++found[full];
    if (lazy == CollisionClass::kPotential)
      narrowed += full != lazy;
    else
      EXPECT_EQ(lazy, full) << i << ", " << mixed::kGrades[i % mixed::kGradesOf];
  }
  for (const auto& [which, count] : found) std::printf("%d of class %d, ", count, int(which));
  std::printf("%d narrowed\n", narrowed);
  EXPECT_GT(found[CollisionClass::kReal], test::effort(5));
  EXPECT_GT(found[CollisionClass::kNone], test::effort(5));
  EXPECT_GT(found[CollisionClass::kFake], 0);
}

}  // namespace
}  // namespace mortise
