#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "common/base/check.h"
#include "common/base/hash.h"
#include "common/base/ids.h"
#include "common/base/in_quotes.h"
#include "common/base/result.h"

namespace mortise {
namespace {

TEST(Ids, ZeroIsNoneAndKindsDoNotMix) {
  EXPECT_FALSE(PartId{});
  EXPECT_TRUE(PartId{1});
  EXPECT_LT(PartId{1}, PartId{2});
  static_assert(!std::is_convertible_v<PartId, UserId>);
}

TEST(Result, HoldsAValueOrAReason) {
  const Result<int> good = 3;
  const Result<int> bad = fail(Code::kInvalidInput, "part.stl: no triangles; export it again");
  ASSERT_TRUE(good);
  EXPECT_EQ(*good, 3);
  ASSERT_FALSE(bad);
  EXPECT_EQ(exit_code_of(bad.error().code), kExitBadInput);
  EXPECT_EQ(exit_code_of(Code::kMismatch), kExitMismatch);
  EXPECT_EQ(exit_code_of(Code::kRuntime), kExitRuntime);
}

TEST(ContentHash, IsStableAndSensitive) {
  // The value of XXH3-128 of the empty input is published with the algorithm.
  EXPECT_EQ(content_hash({}), "99aa06d3014798d86001c324468d497f");
  std::vector<std::byte> bytes(100, std::byte{7});
  const std::string before = content_hash(bytes);
  bytes[50] = std::byte{8};
  EXPECT_NE(content_hash(bytes), before);
}

TEST(StateHash, DependsOnValuesAndOrderButNotOnTheSignOfZero) {
  const auto hash_of = [](std::vector<double> values) {
    StateHash hash;
    for (const double value : values) hash.add(value);
    return hash.value();
  };
  EXPECT_EQ(hash_of({1.0, 2.0}), hash_of({1.0, 2.0}));
  EXPECT_NE(hash_of({1.0, 2.0}), hash_of({2.0, 1.0}));
  EXPECT_NE(hash_of({1.0}), hash_of({1.0 + 1e-15}));
  EXPECT_EQ(hash_of({0.0}), hash_of({-0.0}));
}

TEST(InQuotes, IsOneLineOfBoundedLength) {
  EXPECT_EQ(in_quotes("gear_in.stl"), "'gear_in.stl'");
  EXPECT_EQ(in_quotes("two\nlines\t\x7f"), "'two?lines?\?'");
  EXPECT_EQ(in_quotes(std::string("a\0b", 3)), "'a?b'");
  EXPECT_LT(in_quotes(std::string(100'000, 'x')).size(), 130U);
  // Cut between characters, not within the two bytes of one.
  EXPECT_EQ(in_quotes("x" + std::string(59, 'y') +
                      std::string("\xc3\x98\xc3\x98\xc3\x98\xc3\x98"
                                  "\xc3\x98\xc3\x98\xc3\x98\xc3\x98\xc3\x98\xc3\x98") +
                      std::string(39, 'z') + "\xc3\x98tail"),
            "'x" + std::string(59, 'y') +
                "\xc3\x98\xc3\x98\xc3\x98\xc3\x98\xc3\x98\xc3\x98"
                "\xc3\x98\xc3\x98\xc3\x98\xc3\x98" +
                std::string(39, 'z') + "...'");
}

TEST(CheckDeathTest, SaysWhereAndWhatBeforeItStops) {
  EXPECT_DEATH(MORTISE_CHECK(1 == 2, "planted fault"), "base_test.cpp.*1 == 2.*planted fault");
}

}  // namespace
}  // namespace mortise
