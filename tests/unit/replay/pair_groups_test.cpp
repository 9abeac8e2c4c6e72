// One pair of parts is one clash in lists, however many places it has.
#include "client/report/pair_groups.h"

#include <gtest/gtest.h>

namespace mortise {
namespace {

using Type = Table::Type;

Table clashes(std::vector<std::vector<Json>> rows) {
  return {"clashes",
          "",
          {{"part_a", Type::kText},
           {"part_b", Type::kText},
           {"class", Type::kText},
           {"margin_mm", Type::kNumber},
           {"probability", Type::kNumber},
           {"begin_tick", Type::kInteger},
           {"end_tick", Type::kInteger}},
          std::move(rows)};
}

TEST(PairGroups, TheWorstPlaceLeadsAndTheOthersAreCounted) {
  std::vector<std::vector<Json>> rows;
  for (int i = 0; i < 8; ++i)  // one peg in one hole
    rows.push_back({"plate", "peg", "potential", 0.001, 0.1 * (i % 5), 10, nullptr});
  const auto groups = pair_groups(clashes(rows));
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_EQ(groups[0].lead, 4U);
  EXPECT_EQ(groups[0].others.size(), 7U);
  EXPECT_EQ(also_text(groups[0]), "+7 places");
}

TEST(PairGroups, PlacesOfAnotherTimeAreTimes) {
  const auto groups = pair_groups(clashes({{"a", "b", "real", 0.2, 1, 10, 20},
                                           {"a", "b", "real", 0.1, 1, 15, 30},
                                           {"a", "b", "fake", 0.1, 0, 20, 30},
                                           {"a", "b", "fake", 0.1, 0, 40, nullptr}}));
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_EQ(also_text(groups[0]), "+1 place, +2 times");
  EXPECT_EQ(also_text({0, {}, 0}), "");
}

TEST(PairGroups, RealOnesAreFirst) {
  const auto groups = pair_groups(clashes({{"a", "b", "fake", 0.001, 0, 0, 9},
                                           {"a", "c", "potential", 0.0, 0.9, 0, 9},
                                           {"a", "d", "real", 0.001, 1, 0, 9},
                                           {"a", "e", "real", 0.5, 1, 0, 9},
                                           {"a", "f", "fake", 0.0, 0, 0, 9},
                                           {"a", "b", "real", nullptr, 1, 0, 9}}));
  std::vector<std::size_t> leads;
  for (const PairGroup& group : groups) leads.push_back(group.lead);
  EXPECT_EQ(leads, (std::vector<std::size_t>{3, 2, 5, 1, 4}));
}

// How deep says less than how probable: a mesh error may be all of it.
TEST(PairGroups, WhereNoProbabilityIsKnownTheDeeperIsFirst) {
  const auto row = [](const char* other, Json probability, Json overlap) {
    return std::vector<Json>{"a", other, "potential", 0.0, probability, 0, 9, overlap};
  };
  Table table = clashes({row("b", nullptr, 0.01), row("c", 0.2, -0.1), row("d", nullptr, 0.3),
                         row("e", 0.0, 0.0), row("f", 0.9, -0.2), row("g", nullptr, -0.1)});
  table.columns.push_back({"overlap_lo_mm", Type::kNumber});
  std::vector<std::size_t> leads;
  for (const PairGroup& group : pair_groups(table)) leads.push_back(group.lead);
  EXPECT_EQ(leads, (std::vector<std::size_t>{4, 1, 3, 2, 0, 5}));
}

}  // namespace
}  // namespace mortise
