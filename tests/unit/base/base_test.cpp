#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "common/base/check.h"
#include "common/base/file_text.h"
#include "common/base/hash.h"
#include "common/base/ids.h"
#include "common/base/in_quotes.h"
#include "common/base/nearest_rank.h"
#include "common/base/plain_text.h"
#include "common/base/ranges.h"
#include "common/base/result.h"
#include "common/base/union_find.h"
#include "tests/support/test_folder.h"

namespace mortise {
namespace {

TEST(FileText, HasTheBytesOfAFileUpToABound) {
  const test::TestFolder folder;
  const std::string file = folder.write("a.txt", std::string("one\0\r\ntwo", 9));
  const auto whole = file_text(file), part = file_text(file, 4);
  ASSERT_TRUE(whole && part);
  EXPECT_EQ(*whole, std::string("one\0\r\ntwo", 9));
  EXPECT_EQ(*part, std::string("one\0", 4));
  for (const auto& [name, says] :
       {std::pair{folder.path() / "b.txt", "cannot be read; check the path"},
        std::pair{folder.path(), "is a folder; name a file"},
        std::pair{std::filesystem::path("/dev/zero"), "is a pipe or a device"}}) {
    const auto refused = file_text(name);
    ASSERT_FALSE(refused) << name;
    EXPECT_NE(refused.error().text.find(says), std::string::npos) << refused.error().text;
  }
}

TEST(Ids, ZeroIsNoneAndKindsDoNotMix) {
  EXPECT_FALSE(PartId{});
  EXPECT_TRUE(PartId{1});
  EXPECT_LT(PartId{1}, PartId{2});
  static_assert(!std::is_convertible_v<PartId, UserId>);
}

TEST(UnionFind, TheLeastNumberLeadsHoweverSetsWereJoined) {
  UnionFind one(5), other(4);
  other.add();
  one.join(4, 2);
  one.join(2, 1);
  other.join(1, 2);
  other.join(4, 1);
  for (std::uint32_t i = 0; i < 5; ++i) {
    EXPECT_EQ(one.leader_of(i), other.leader_of(i)) << i;
    EXPECT_EQ(one.leads(i), i != 2 && i != 4) << i;
  }
  EXPECT_EQ(one.leader_of(4), 1U);
  EXPECT_EQ(one.count_sets(), 3U);
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

TEST(PlainText, KnowsUtf8FromWhatIsNot) {
  EXPECT_EQ(utf8_prefix("Jäger Ø20 µm 軸 🙂"),
            std::string("Jäger Ø20 µm 軸 🙂").size());
  EXPECT_EQ(utf8_prefix("J\xe4ger"), 1U) << "Latin-1";
  EXPECT_EQ(utf8_prefix("ab\xc3"), 2U) << "half a character";
  EXPECT_EQ(utf8_prefix("a\xc0\x80"), 1U) << "not the shortest form";
  EXPECT_EQ(utf8_prefix("a\xed\xa0\x80"), 1U) << "a surrogate";
  EXPECT_EQ(utf8_prefix("a\xf4\x90\x80\x80"), 1U) << "beyond Unicode";
  EXPECT_EQ(as_utf8("J\xe4ger \xc3"), "J\xef\xbf\xbdger \xef\xbf\xbd");
  EXPECT_EQ(one_line("a\nb\xc2\x85"
                     "c\xe2\x80\xa8"
                     "d\xe2\x80\xae"
                     "e"),
            "a?b?c?d?e");
}

TEST(PlainText, ANameIsSeenAndNotMistaken) {
  for (const char* good : {"ann", "Jäger 2", "軸受", "מיסב", "peg.journal", "*"})
    EXPECT_TRUE(is_name(good)) << good;
  for (const char* bad : {"", " ", "\xc2\xa0", "\xe3\x80\x80", "a\nb", "a\tb", "a\x7f", "J\xe4ger",
                          "a\xc2\x9b"
                          "b",
                          "a\xe2\x80\xae"
                          "b",
                          "a\xe2\x81\xa6"
                          "b",
                          "a\xe2\x80\x8b"
                          "b",
                          "\xef\xbb\xbf"
                          "a"})
    EXPECT_FALSE(is_name(bad)) << one_line(bad);
  EXPECT_TRUE(is_name(std::string(kMostName_bytes, 'a')));
  EXPECT_FALSE(is_name(std::string(kMostName_bytes + 1, 'a')));
  EXPECT_FALSE(is_name(std::string(kMostUserName_bytes + 1, 'a'), kMostUserName_bytes));
}

TEST(PlainText, ASessionNameIsPartOfAFileName) {
  for (const char* good : {"default", "demo-2", "line_3.a"}) EXPECT_TRUE(is_session_name(good));
  for (const char* bad : {"", "..", "../x", "a/b", "a b", "a\nb", ".hidden", "*", "ä"})
    EXPECT_FALSE(is_session_name(bad)) << bad;
  EXPECT_FALSE(is_session_name(std::string(65, 'a')));
}

TEST(Ranges, WhatIsNotFiniteLiesInNone) {
  EXPECT_TRUE(within(-kLongest_mm, kLongest_mm));
  EXPECT_FALSE(within(2.0 * kLongest_mm, kLongest_mm));
  EXPECT_FALSE(within(std::nan(""), kLongest_mm));
  EXPECT_FALSE(within(HUGE_VAL, kLongest_mm));
}

TEST(NearestRank, IsTheCeilingOfTheShare) {
  EXPECT_EQ(nearest_rank(40, 0.99), 39U);
  EXPECT_EQ(nearest_rank(100, 0.99), 98U);
  EXPECT_EQ(nearest_rank(101, 0.99), 99U);
  EXPECT_EQ(nearest_rank(100, 0.07), 6U) << "0.07 * 100 is a little more than 7";
  EXPECT_EQ(nearest_rank(2, 0.5), 0U);
  EXPECT_EQ(nearest_rank(1, 0.0), 0U);
  EXPECT_EQ(nearest_rank(3, 1.0), 2U);
  EXPECT_EQ(quantile_of_sorted({1.0, 2.0, 3.0}, 0.5), 2.0);
  EXPECT_EQ(quantile_of_sorted({}, 0.5), 0.0);
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
