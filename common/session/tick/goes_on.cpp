#include "common/session/tick/goes_on.h"

#include <algorithm>
#include <cmath>

#include "common/base/constants.h"
#include "common/session/tick/clash_identity.h"
#include "common/session/tick/contacts.h"
#include "common/session/tick/pair_queries.h"
#include "common/session/tick/stop_time.h"

namespace mortise {
namespace {

// Each pair has a tick of its own, so that not all are looked at in the same one.
bool is_due(const World& world, const PairWork& pair) {
  return (world.tick + pair.ids.a + pair.ids.b) % kLookAgain_ticks == 0;
}

// The class that all open clashes have as last seen; kNone: they differ. Another class may be told,
// which is not left far enough; that is for a look to say.
CollisionClass seen_class(const std::vector<OpenClash>& open) {
  const CollisionClass seen = open.front().now.collision_class;
  const bool all = std::all_of(open.begin(), open.end(), [&](const OpenClash& clash) {
    return clash.now.collision_class == seen;
  });
  return all ? seen : CollisionClass::kNone;
}

// A clash of parts that come apart ends at some distance.
bool is_as_near(PairWork& pair, CcdScratch& ccd) {
  const double limit_mm = pair.ids.band_mm + kClashHysteresis_mm;
  return pair_distance(pair, pair.segment.motion_a.X_W1, pair.segment.motion_b.X_W1, limit_mm, ccd)
      .within_limit;
}

}  // namespace

bool may_go_on(const World& world, const PairWork& pair) {
  const PairMemo& memo = *pair.ids.memo;
  return pair.ids.open && !pair.ids.open->empty() && !pair.ids.placed && !pair.ids.plain() &&
         !pair.ids.no_inside() && !memo.not_judged && !memo.not_seen &&
         std::isinf(memo.allowed_depth_mm) && !is_due(world, pair);
}

bool goes_on(PairWork& pair, CcdScratch& ccd) {
  switch (seen_class(*pair.ids.open)) {
    case CollisionClass::kFake:
      return is_never_possible(pair) && is_as_near(pair, ccd);
    case CollisionClass::kPotential:
      // The point speaks of one place.
      return pair.ids.open->size() == 1 && free_by_covers(pair) >= 1.0 &&
             pair.answer.certain_free->closely && is_possible_at_end(pair);
    default:
      return false;
  }
}

bool is_never_possible(PairWork& pair) {
  return is_free_of_possible(swept_query(pair), pair.effort.counts.depth_evaluations);
}

bool is_possible_at_end(PairWork& pair) {
  std::uint64_t& evaluations = pair.effort.counts.depth_evaluations;
  return said_by_covers(overlap_query(pair, 1.0), Named::kLargest, evaluations).place.has_value();
}

bool lingers(const World& world, PairWork& pair) {
  return may_go_on(world, pair) && pair.status.never_real && pair.ids.open->size() == 1 &&
         pair.ids.open->front().last.verdict.collision_class == CollisionClass::kReal &&
         is_possible_at_end(pair);
}

bool is_told_there(const World& world, const PairWork& pair) {
  return may_go_on(world, pair) && pair.answer.place.known() &&
         std::any_of(pair.ids.open->begin(), pair.ids.open->end(), [&](const OpenClash& clash) {
           return clash.last.verdict.collision_class == CollisionClass::kReal &&
                  is_at(clash, pair.answer.place, pair);
         });
}

}  // namespace mortise
