#include "common/session/tick/stage_checks.h"

#include <gtest/gtest.h>

#include <limits>

#include "common/session/memory/session_state.h"
#include "tests/unit/session/session_builder.h"

// Each check passes what a tick makes, and ends the process at a planted fault.
namespace mortise {
namespace {

/// Two cubes side by side, the first of which moves.
struct Planted {
  SessionBuilder session;
  Scratch::Impl work{1};
  std::vector<OpenClash> open;

  Planted() {
    session.add("a", cube_mesh(10.0), at(0, 0, 0), true);
    session.add("b", cube_mesh(10.0), at(20, 0, 0), true);
    work.moves.resize(1);
    PairWork pair;
    pair.ids.b = 1;
    pair.ids.move_a = 0;
    const std::vector<Part>& parts = session.world.parts;
    pair.ids.solid_a = parts[0].solid.get();
    pair.ids.solid_b = parts[1].solid.get();
    pair.ids.band_a = &parts[0].band;
    pair.ids.band_b = &parts[1].band;
    pair.status.asked = true;
    SeenRegion region;
    region.verdict.collision_class = CollisionClass::kFake;
    pair.judged.seen.push_back(region);
    work.pairs.push_back(std::move(pair));
    work.pair_count = 1;
  }
  PairWork& pair() { return work.pairs.front(); }
  Verdict& verdict() { return pair().judged.seen.front().verdict; }

  void check() {
    check_pairs(session.world, work);
    check_contacts(work);
    check_verdicts(work);
  }
};

template <class Change>
void with(Change change) {
  Planted planted;
  change(planted);
  planted.check();
}

TEST(StageChecks, WhatIsRightPasses) { Planted{}.check(); }

TEST(StageChecks, AWrongPairIsFound) {
  EXPECT_DEATH(with([](Planted& p) { p.pair().ids.b = 0; }), "the lower index first");
  EXPECT_DEATH(with([](Planted& p) { p.pair().ids.b = 2; }), "the lower index first");
  EXPECT_DEATH(with([](Planted& p) {
                 p.work.pairs.push_back(p.pair());
                 p.work.pair_count = 2;
               }),
               "each pair stands once");
  EXPECT_DEATH(with([](Planted& p) { p.pair().ids.move_a = -1; }), "one part of a pair has a move");
  EXPECT_DEATH(with([](Planted& p) { p.pair().ids.band_b = nullptr; }), "two solids with a band");
  EXPECT_DEATH(with([](Planted& p) { p.pair().ids.band_mm = -1.0; }), "is a length");
}

TEST(StageChecks, AWrongContactIsFound) {
  EXPECT_DEATH(with([](Planted& p) { p.pair().segment.tau = 1.0; }), "before the tick ends");
  EXPECT_DEATH(with([](Planted& p) { p.pair().answer.t_contact = 1.5; }), "times of the tick");
  EXPECT_DEATH(with([](Planted& p) { p.pair().answer.t_stop = std::nan(""); }),
               "times of the tick");
  EXPECT_DEATH(with([](Planted& p) { p.pair().status.apart_at_end_mm = -1e-3; }),
               "is not negative");
  EXPECT_DEATH(with([](Planted& p) { p.pair().status.blocks = true; }),
               "holds a part back is near");
  EXPECT_DEATH(with([](Planted& p) { p.work.moves[0].stop = 2.0; }), "a time of the tick");
  EXPECT_DEATH(with([](Planted& p) { p.work.moves[0].X_WP_end.p.x() = std::nan(""); }),
               "a pose is finite");
}

TEST(StageChecks, AWrongVerdictIsFound) {
  EXPECT_DEATH(with([](Planted& p) { p.pair().judged.seen[0].open = 0; }),
               "continues an open clash");
  EXPECT_DEATH(with([](Planted& p) { p.verdict().collision_class = CollisionClass::kNone; }),
               "a region has a class");
  EXPECT_DEATH(with([](Planted& p) { p.verdict().delta_mm = {2.0, 1.0}; }), "lower end first");
  EXPECT_DEATH(with([](Planted& p) { p.verdict().gpd_mm = {2.0, 1.0}; }), "lower end first");
  EXPECT_DEATH(with([](Planted& p) { p.verdict().margin_mm = -1.0; }), "a margin is a distance");
  EXPECT_DEATH(with([](Planted& p) { p.verdict().probability = 1.5; }), "at most 1");
}

TEST(StageChecks, AWrongCommitIsFound) {
  Planted planted;
  SessionState state;
  StepReport report;
  report.moved.resize(1);
  report.moved[0].part = planted.session.world.parts[0].id;
  check_committed(planted.session.world, state, report);
  report.moved[0].part = PartId{9};
  EXPECT_DEATH(check_committed(planted.session.world, state, report), "only moving parts");
  report.moved.clear();
  state.owed = {{1, 2}, {0, 1}};
  EXPECT_DEATH(check_committed(planted.session.world, state, report), "stand in their order");
}

}  // namespace
}  // namespace mortise
