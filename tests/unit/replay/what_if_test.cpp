// What a session would have been: replay with changes gives what playing it with them gives.
#include "client/replay/sweep.h"
#include "client/report/summary_tables.h"
#include "common/messages/names.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/unit/io/log_samples.h"
#include "tests/unit/replay/played.h"

namespace mortise {
namespace {

std::vector<Change> changes(const std::vector<std::string>& texts) {
  std::vector<Change> made;
  for (const std::string& text : texts) {
    auto change = read_change(text);
    EXPECT_TRUE(change) << change.error().text;
    if (change) made.push_back(std::move(*change));
  }
  return made;
}

void expect_same(const Clashes& x, const Clashes& y) {
  ASSERT_EQ(x.rows.size(), y.rows.size());
  for (std::size_t i = 0; i < x.rows.size(); ++i) {
    EXPECT_EQ(x.rows[i].a, y.rows[i].a) << i;
    EXPECT_EQ(x.rows[i].b, y.rows[i].b) << i;
    EXPECT_EQ(x.rows[i].begin_tick, y.rows[i].begin_tick) << i;
    EXPECT_EQ(x.rows[i].end_tick, y.rows[i].end_tick) << i;
    EXPECT_EQ(x.rows[i].worst_class, y.rows[i].worst_class) << i;
    EXPECT_EQ(x.rows[i].worst.delta_mm, y.rows[i].worst.delta_mm) << i;
    EXPECT_EQ(x.rows[i].worst.real_above_mm, y.rows[i].worst.real_above_mm) << i;
  }
}

struct Replaced {
  const char* scenario;
  const char* from;
  const char* to;
  std::vector<std::string> change;
};

TEST(WhatIf, GivesWhatPlayingItGives) {
  const Replaced lives[] = {
      {"blocks_profile", "policy: report", "policy: stop", {"policy = stop"}},
      {"blocks_profile",
       "+-0.05",
       "+-0.2",
       {"tolerance base_1 = +-0.2", "tolerance base_2 = +-0.2", "tolerance base_3 = +-0.2",
        "tolerance base_4 = +-0.2", "tolerance overlap_200 = +-0.2", "tolerance overlap_50 = +-0.2",
        "tolerance gap_50 = +-0.2", "tolerance gap_200 = +-0.2"}},
      {"peg_in_hole", "policy: stop", "policy: report", {"policy = report"}},
      // The demo: the press fit as one that goes together by hand.
      {"gearbox",
       "code: Ø35 H7/p6",
       "code: Ø35 H7/h6",
       {"fit cover.seat_out, bearing_out_upper.outer = Ø35 H7/h6"}}};
  for (const Replaced& live : lives) {
    const auto log = played(live.scenario), other = played(live.scenario, live.from, live.to);
    ASSERT_TRUE(log && other) << live.scenario;
    const auto base = clashes_with(*log, {}), replayed = clashes_with(*log, changes(live.change));
    const auto truth = clashes_with(*other, {});
    ASSERT_TRUE(base && replayed && truth) << live.scenario;
    expect_same(*replayed, *truth);
    EXPECT_GT(truth->rows.size(), 0U) << live.scenario;
  }
}

TEST(WhatIf, NamesWhatChangedAndWhy) {
  const auto log = played("blocks_profile");
  ASSERT_TRUE(log) << log.error().text;
  const auto before = clashes_with(*log, {});
  ASSERT_TRUE(before);
  Variant variant{0, {"tolerance overlap_50 = ±0.001", "tolerance base_2 = ±0.001"}, {}, ""};
  auto after = clashes_with(*log, changes(variant.changes));
  ASSERT_TRUE(after) << after.error().text;
  variant.clashes = std::move(*after);
  const Json document = json_of(variant, *before);
  ASSERT_GE(document["changed"].size(), 1U) << document.dump(1);
  for (const Json& row : document["changed"]) {
    EXPECT_EQ(row["pair"], "base_2 × overlap_50");
    EXPECT_EQ(row["before"]["class"], "potential");
    EXPECT_EQ(row["after"]["class"], "real");
  }
  const std::string text = text_of(variant, *before);
  EXPECT_NE(text.find("was potential"), std::string::npos) << text;
  EXPECT_NE(text.find("is  real"), std::string::npos) << text;
  // The same session again: nothing has changed.
  Variant same{0, {}, *before, ""};
  EXPECT_EQ(json_of(same, *before)["changed"].size(), 0U);
}

TEST(WhatIf, AClashIsMatchedOnce) {
  Clashes before, after;
  const auto row = [](std::uint32_t a, std::uint64_t begin, std::uint64_t end, double x) {
    SessionStatistics::ClashRow made;
    made.a = PartId{a}, made.b = PartId{9};
    made.begin_tick = begin, made.end_tick = end;
    made.worst.point_W = Vec3(x, 0, 0);
    return made;
  };
  before.rows = {row(1, 10, 100, 0), row(2, 10, 20, 0)};
  after.rows = {row(1, 10, 30, 0), row(1, 40, 100, 5), row(1, 200, 300, 0)};
  const auto pairs = matched(before, after);
  ASSERT_EQ(pairs.size(), 4U);
  EXPECT_EQ(pairs[0].before, ClashPair::kNone);  // less in common than the next one
  EXPECT_EQ(pairs[1].before, 0U);
  EXPECT_EQ(pairs[2].before, ClashPair::kNone);
  EXPECT_EQ(pairs[3].before, 1U);
  EXPECT_EQ(pairs[3].after, ClashPair::kNone);
}

TEST(WhatIf, RefusesWhatItCannotDo) {
  for (const char* text : {"", "colour = red", "policy", "tolerance = 1", "fit a = H7/g6",
                           "fit a, b, c = H7/g6", "include a, b = x", "exclude a, = x"})
    EXPECT_FALSE(read_change(text)) << text;
  const auto log = played("blocks_profile");
  ASSERT_TRUE(log);
  for (const char* text : {"policy = bounce", "tolerance nobody = ±0.1", "tolerance base_1 = wide",
                           "tolerance base_1.bore = ±0.1", "mesh base_1 = nowhere.stl",
                           "mesh nobody = nowhere.stl", "fit base_1, base_1 = H7/g6"}) {
    const auto answer = clashes_with(*log, changes({text}));
    ASSERT_FALSE(answer) << text;
    EXPECT_NE(answer.error().text.find(
                  text == std::string("mesh base_1 = nowhere.stl") ? "nowhere.stl" : "change '"),
              std::string::npos)
        << answer.error().text;
  }
}

// A slip of the pen is found before the session is computed.
TEST(WhatIf, IsCheckedBeforeItIsComputed) {
  auto log = played("blocks_profile");
  ASSERT_TRUE(log);
  // A session that cannot be computed: only the check can answer.
  for (TickRecord& record : log->ticks) record.tick = 1;
  const auto variant = [](std::size_t index, const char* change) {
    return Variant{index, {change}, {}, ""};
  };
  EXPECT_TRUE(check_variants(*log, {variant(0, "tolerance base_1 = ±0.2")}, 2));
  const Status wrong = check_variants(
      *log, {variant(0, "tolerance base_1 = ±0.2"), variant(1, "tolerance nobody = ±0.2")}, 2);
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().text.find("nobody"), std::string::npos);
  EXPECT_FALSE(clashes_with(*log, {}));
}

// The closed form of the report, against the session computed again with other tolerances.
TEST(WhatIf, WiderZonesGiveTheClassesThatTheReportForetells) {
  const auto log = played("blocks_profile");
  ASSERT_TRUE(log);
  const auto before = clashes_with(*log, {});
  ASSERT_TRUE(before);
  std::size_t compared = 0, other = 0;
  for (const double widening_mm : {-0.04, -0.02, 0.05, 0.15}) {
    char text[32];
    std::snprintf(text, sizeof text, "±%g", 0.05 + widening_mm);
    std::vector<std::string> texts;
    for (const char* part :
         {"base_1", "base_2", "base_3", "base_4", "overlap_200", "overlap_50", "gap_50", "gap_200"})
      texts.push_back(std::string("tolerance ") + part + " = " + text);
    const auto after = clashes_with(*log, changes(texts));
    ASSERT_TRUE(after) << after.error().text;
    for (const ClashPair& pair : matched(*before, *after)) {
      if (pair.before == ClashPair::kNone || pair.after == ClashPair::kNone) continue;
      const Verdict& was = before->rows[pair.before].worst;
      const Verdict& is = after->rows[pair.after].worst;
      if (was.delta_mm.lo != is.delta_mm.lo) continue;  // another moment is the worst one now
      const std::string foretold = class_when_widened(
          was.delta_mm.lo, was.delta_mm.hi, was.fake_below_mm, was.real_above_mm, widening_mm);
      EXPECT_EQ(foretold, name_of(is.collision_class)) << is.explanation;
      ++compared;
      other += was.collision_class != is.collision_class;
    }
  }
  EXPECT_GE(compared, 6U);
  EXPECT_GE(other, 2U);
}

TEST(WhatIf, SweepsGiveTheSameAtAnyNumberOfThreads) {
  const auto log = played("blocks_profile");
  ASSERT_TRUE(log);
  const auto swept = [&](int jobs) {
    std::vector<Variant> variants;
    for (const char* zone : {"+-0.02", "+-0.05", "+-0.1", "+-0.2"})
      variants.push_back({variants.size(), {std::string("tolerance base_1 = ") + zone}, {}, {}});
    EXPECT_TRUE(check_variants(*log, variants, jobs));
    std::size_t done = 0;  // told by one thread at a time
    compute_variants(*log, variants, jobs, [&](std::size_t) { ++done; });
    EXPECT_EQ(done, variants.size());
    return variants;
  };
  const std::vector<Variant> alone = swept(1), together = swept(3);
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(together[i].error, "");
    expect_same(alone[i].clashes, together[i].clashes);
  }
}

TEST(WhatIf, SweepsAreSpelledOut) {
  const auto list = variants_of("tolerance a = ±[0.01, 0.02]");
  ASSERT_TRUE(list);
  EXPECT_EQ(*list, (std::vector<std::string>{"tolerance a = ±0.01", "tolerance a = ±0.02"}));
  const auto range = variants_of("fit a, b = H[6,7]/g[0..1/3]");
  ASSERT_TRUE(range);
  EXPECT_EQ(range->size(), 6U);
  EXPECT_EQ(range->back(), "fit a, b = H7/g1");
  EXPECT_EQ((*range)[1], "fit a, b = H6/g0.5");
  for (const char* text :
       {"a = [1", "a = [1..2]", "a = [1..2/1]", "a = [x..2/3]", "a = [1..2/99999]"})
    EXPECT_FALSE(variants_of(text)) << text;
}

}  // namespace
}  // namespace mortise
