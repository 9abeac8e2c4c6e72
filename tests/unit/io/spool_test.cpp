#include "common/io/log/spool.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace mortise {
namespace {

std::vector<std::byte> read_back(const Spool& spool) {
  std::vector<std::byte> all;
  EXPECT_TRUE(spool.read([&](auto bytes) { all.insert(all.end(), bytes.begin(), bytes.end()); }));
  return all;
}

// Pieces of 0 to 3000 bytes, 15 MB in all. Returns what was appended.
std::vector<std::byte> fill(Spool& spool, std::size_t& most_in_memory) {
  std::mt19937_64 random(5);
  std::vector<std::byte> all;
  for (int i = 0; i < 10'000; ++i) {
    std::vector<std::byte> piece(random() % 3000);
    for (std::byte& byte : piece) byte = static_cast<std::byte>(random());
    spool.append(piece);
    all.insert(all.end(), piece.begin(), piece.end());
    most_in_memory = std::max(most_in_memory, spool.in_memory());
  }
  return all;
}

TEST(Spool, GivesBackWhatCameInAndKeepsABlock) {
  Spool spool(testing::TempDir());
  std::size_t most = 0;
  const auto all = fill(spool, most);
  EXPECT_EQ(spool.size(), all.size());
  EXPECT_EQ(read_back(spool), all);
  EXPECT_EQ(read_back(spool), all);  // any number of times
  EXPECT_LT(most, Spool::kBlockBytes + 3000);
}

TEST(Spool, StaysInMemoryWhereThereAreNoFiles) {
  Spool spool("/proc");
  std::size_t most = 0;
  const auto all = fill(spool, most);
  EXPECT_EQ(most, all.size());
  EXPECT_EQ(read_back(spool), all);
}

TEST(Spool, IsEmptyAtFirst) {
  const Spool spool("");
  EXPECT_EQ(spool.size(), 0u);
  EXPECT_TRUE(read_back(spool).empty());
}

}  // namespace
}  // namespace mortise
