#include "common/session/tick/worker_pool.h"

#include <gtest/gtest.h>

#include <numeric>

namespace mortise {
namespace {

TEST(WorkerPool, DoesEveryIndexOnceInEveryRound) {
  for (const int threads : {1, 2, 4}) {
    WorkerPool pool(threads);
    EXPECT_EQ(pool.threads(), threads);
    for (int round = 0; round < 300; ++round) {
      const std::size_t count = static_cast<std::size_t>(round % 17);
      std::vector<int> done(count, 0);
      pool.for_each(count, [&](std::size_t i, int thread) {
        EXPECT_GE(thread, 0);
        EXPECT_LT(thread, threads);
        ++done[i];
      });
      EXPECT_EQ(std::accumulate(done.begin(), done.end(), 0), static_cast<int>(count));
      for (const int n : done) EXPECT_EQ(n, 1);
    }
  }
}

TEST(WorkerPool, MoreThreadsThanWork) {
  WorkerPool pool(8);
  std::vector<int> done(2, 0);
  pool.for_each(2, [&](std::size_t i, int) { ++done[i]; });
  EXPECT_EQ(done, (std::vector<int>{1, 1}));
}

}  // namespace
}  // namespace mortise
