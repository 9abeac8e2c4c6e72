#include "common/broadphase/pair_filter.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

TEST(PairFilter, NamesTheFirstReason) {
  const FilterPart fixed{false, false}, still{true, false}, moved{true, true};
  EXPECT_EQ(filter_pair(fixed, fixed, false), PairSkip::kStatic);
  EXPECT_EQ(filter_pair(fixed, fixed, true), PairSkip::kStatic);
  EXPECT_EQ(filter_pair(still, fixed, false), PairSkip::kStill);
  EXPECT_EQ(filter_pair(still, still, true), PairSkip::kStill);
  EXPECT_EQ(filter_pair(moved, fixed, true), PairSkip::kExcluded);
  EXPECT_EQ(filter_pair(moved, fixed, false), PairSkip::kAsk);
  EXPECT_EQ(filter_pair(still, moved, false), PairSkip::kAsk);
  EXPECT_EQ(filter_pair(moved, moved, false), PairSkip::kAsk);
}

// Counting must say what asking every pair would say.
TEST(PairFilter, CensusAgreesWithAskingEveryPair) {
  for (unsigned n = 0; n < 9; ++n)
    for (unsigned can_move = 0; can_move <= n; ++can_move)
      for (unsigned moved = 0; moved <= can_move; ++moved) {
        PairCensus expected;
        for (unsigned i = 0; i < n; ++i)
          for (unsigned j = i + 1; j < n; ++j) {
            ++expected.all;
            const PairSkip skip =
                filter_pair({i < can_move, i < moved}, {j < can_move, j < moved}, false);
            expected.both_static += skip == PairSkip::kStatic;
            expected.both_still += skip == PairSkip::kStill;
          }
        const PairCensus census = count_pairs(n, can_move, moved);
        EXPECT_EQ(census.all, expected.all);
        EXPECT_EQ(census.both_static, expected.both_static);
        EXPECT_EQ(census.both_still, expected.both_still);
      }
}

}  // namespace
}  // namespace mortise
