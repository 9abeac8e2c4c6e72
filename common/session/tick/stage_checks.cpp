#include "common/session/tick/stage_checks.h"

#include <algorithm>
#include <span>

#include "common/base/check.h"

namespace mortise {
namespace {

bool within_tick(double t) { return t >= 0.0 && t <= 1.0; }

std::span<const PairWork> pairs_of(const Scratch::Impl& work) {
  return std::span(work.pairs).first(work.pair_count);
}

}  // namespace

void check_pairs(const World& world, const Scratch::Impl& work) {
  const PairWork* before = nullptr;
  for (const PairWork& pair : pairs_of(work)) {
    MORTISE_CHECK(pair.ids.a < pair.ids.b && pair.ids.b < world.parts.size(),
                  "a pair is of two parts, the lower index first");
    MORTISE_CHECK(!before || before->ids.a < pair.ids.a ||
                      (before->ids.a == pair.ids.a && before->ids.b < pair.ids.b),
                  "each pair stands once, in order");
    MORTISE_CHECK(pair.ids.move_a >= 0 || pair.ids.move_b >= 0, "one part of a pair has a move");
    MORTISE_CHECK(pair.ids.solid_a && pair.ids.solid_b && pair.ids.band_a && pair.ids.band_b,
                  "a pair has two solids with a band each");
    MORTISE_CHECK(pair.ids.band_mm >= 0.0, "the distance at which a pair is looked at is a length");
    before = &pair;
  }
}

void check_contacts(const Scratch::Impl& work) {
  for (const PairWork& pair : pairs_of(work)) {
    if (!pair.status.asked) continue;
    MORTISE_CHECK(pair.segment.tau >= 0.0 && pair.segment.tau < 1.0,
                  "a leg begins before the tick ends");
    MORTISE_CHECK(within_tick(pair.answer.t_contact) && within_tick(pair.answer.t_enter) &&
                      within_tick(pair.answer.t_stop),
                  "contact, entry and stop are times of the tick");
    MORTISE_CHECK(pair.status.apart_at_end_mm >= 0.0, "a distance is not negative");
    MORTISE_CHECK(!pair.status.blocks || pair.status.near, "a pair that holds a part back is near");
  }
  for (const Move& move : work.moves) {
    MORTISE_CHECK(within_tick(move.stop), "a stop is a time of the tick");
    MORTISE_CHECK(valid(move.X_WP_end), "a pose is finite and its quaternion unit");
  }
}

void check_verdicts(const Scratch::Impl& work) {
  for (const PairWork& pair : pairs_of(work)) {
    const int open = pair.ids.open ? static_cast<int>(pair.ids.open->size()) : 0;
    for (const SeenRegion& region : pair.judged.seen) {
      const Verdict& verdict = region.verdict;
      MORTISE_CHECK(region.open >= -1 && region.open < open, "a region continues an open clash");
      MORTISE_CHECK(verdict.collision_class != CollisionClass::kNone, "a region has a class");
      MORTISE_CHECK(verdict.delta_mm.lo <= verdict.delta_mm.hi,
                    "a bracket has its lower end first");
      MORTISE_CHECK(verdict.gpd_mm.lo <= verdict.gpd_mm.hi, "a bracket has its lower end first");
      MORTISE_CHECK(verdict.margin_mm >= 0.0, "a margin is a distance");
      MORTISE_CHECK(verdict.probability == kProbabilityUnknown || within_tick(verdict.probability),
                    "a probability is at most 1");
      MORTISE_CHECK(verdict.collision_class != CollisionClass::kReal || !pair.ids.no_inside(),
                    "real needs two insides");
    }
  }
}

void check_committed(const World& world, const SessionState& state, const StepReport& report) {
  for (const PartPose& moved : report.moved) {
    const Part* part = world.find(moved.part);
    MORTISE_CHECK(part && part->moving && valid(part->X_WP), "only moving parts have moved");
  }
  MORTISE_CHECK(std::is_sorted(state.owed.begin(), state.owed.end()),
                "pairs that wait stand in their order");
}

}  // namespace mortise
