// What-if on a session in which a part took another mesh: it gives what playing it gives.
#include <fstream>

#include "client/replay/what_if.h"
#include "client/tools/generate/write_mesh.h"
#include "tests/support/test_folder.h"
#include "tests/unit/io/revised_session.h"

namespace mortise {
namespace {

class WhatIfRevised : public RevisedPart {
 protected:
  /// The peg in its hole takes a mesh with other facets, and another one that has no fit; the
  /// second is taken back and given again.
  Result<SessionLog> played(const std::string& text) {
    begin_with(text);
    replace(peg, dowel(20.0, 48));
    tick();
    replace(peg, dowel(20.2, 48));
    tick();
    EXPECT_EQ(ask(CommandKind::kUndo, peg).refusal, Refusal::kNone);
    tick();
    EXPECT_EQ(ask(CommandKind::kRedo, peg).refusal, Refusal::kNone);
    tick();
    EXPECT_EQ(ask(CommandKind::kUndo, peg).refusal, Refusal::kNone);
    tick();
    return written();
  }
  static std::string with(const std::string& from, const std::string& to) {
    std::string text = kPlateAndPeg;
    text.replace(text.find(from), from.size(), to);
    return text;
  }
  static std::vector<Change> change(const std::string& text) {
    auto read = read_change(text);
    EXPECT_TRUE(read) << read.error().text;
    return {std::move(*read)};
  }
};

TEST_F(WhatIfRevised, StatementsHoldOfEachMeshThatThePartTakes) {
  const auto log = played(kPlateAndPeg);
  ASSERT_TRUE(log) << log.error().text;
  const auto before = clashes_with(*log, {});
  ASSERT_TRUE(before) << before.error().text;
  const struct {
    const char *change, *from, *to;
  } lives[] = {
      {"fit plate.bore, peg.journal = Ø20 H7/h6", "H7/k6", "H7/h6"},
      {"tolerance peg = ±0.05", "±0.001", "±0.05"},
      {"policy = stop", "policy: report", "policy: stop"},
  };
  for (const auto& live : lives) {
    SCOPED_TRACE(live.change);
    const auto replayed = clashes_with(*log, change(live.change));
    ASSERT_TRUE(replayed) << replayed.error().text;
    EXPECT_EQ(replayed->stopped_early, "");
    const auto other = played(with(live.from, live.to));
    ASSERT_TRUE(other) << other.error().text;
    const auto truth = clashes_with(*other, {});
    ASSERT_TRUE(truth) << truth.error().text;
    ASSERT_EQ(replayed->rows.size(), truth->rows.size());
    ASSERT_GT(truth->rows.size(), 0U);
    for (std::size_t i = 0; i < truth->rows.size(); ++i) {
      EXPECT_EQ(replayed->rows[i].begin_tick, truth->rows[i].begin_tick);
      EXPECT_EQ(replayed->rows[i].end_tick, truth->rows[i].end_tick);
      EXPECT_EQ(replayed->rows[i].worst_class, truth->rows[i].worst_class);
      EXPECT_EQ(replayed->rows[i].worst.delta_mm, truth->rows[i].worst.delta_mm);
      EXPECT_EQ(replayed->rows[i].worst.real_above_mm, truth->rows[i].worst.real_above_mm);
    }
  }
}

// The session begins with another mesh, and has from then on what it took in the log; also where
// it began with the very mesh that it takes later.
TEST_F(WhatIfRevised, AnotherFirstMeshEndsWhereTheLogReplacesIt) {
  const auto log = played(kPlateAndPeg);
  ASSERT_TRUE(log) << log.error().text;
  const auto before = clashes_with(*log, {});
  ASSERT_TRUE(before) << before.error().text;
  for (const int facets : {48, 40}) {
    SCOPED_TRACE(facets);
    const test::TestFolder folder;
    const auto made = generate("dowel", {{"diameter_mm", 20.0},
                                         {"length_mm", 40},
                                         {"chamfer_mm", 1},
                                         {"facets", facets},
                                         {"phase_rad", 0.098}});
    ASSERT_TRUE(made);
    {
      std::ofstream out(folder.path() / "peg.obj");
      write_obj(made->mesh, {}, out);
    }
    const auto after =
        clashes_with(*log, change("mesh peg = " + (folder.path() / "peg.obj").string()));
    ASSERT_TRUE(after) << after.error().text;
    EXPECT_EQ(after->ticks, before->ticks);
    ASSERT_EQ(after->rows.size(), before->rows.size());
    // What the thick one comes to is worst in both.
    for (std::size_t i = 0; i < before->rows.size(); ++i)
      EXPECT_EQ(after->rows[i].worst.delta_mm, before->rows[i].worst.delta_mm);
  }
}

}  // namespace
}  // namespace mortise
