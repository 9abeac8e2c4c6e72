#include <algorithm>

#include "common/base/constants.h"
#include "common/session/motion_budget.h"
#include "common/session/stop_time.h"
#include "common/session/tick_work.h"

namespace mortise {
namespace {

enum class AtStart { kSay, kIgnoreTouching };

FirstContact ask_first_contact(PairWork& pair, double separation_mm, AtStart at_start,
                               CcdScratch& ccd) {
  ContactQuery query;
  query.a = pair.solid_a;
  query.b = pair.solid_b;
  query.motion_a = pair.motion_a;
  query.motion_b = pair.motion_b;
  query.separation_mm = separation_mm;
  query.ignore_touching_at_start = at_start == AtStart::kIgnoreTouching;
  query.check_contained = !pair.memo->not_contained;
  const FirstContact contact = first_contact(query, ccd);
  ++pair.counts.first_contact_queries;
  pair.counts.box_tests += contact.work.box_tests;
  pair.counts.triangle_tests += contact.work.triangle_tests;
  return contact;
}

// Without a band the parts are their meshes: real is where interiors meet, and first contact says
// when. Touching at the start is no reason to stop anybody; it asks on until the touching places
// press in.
void ask_plain(const World& world, PairWork& pair, CcdScratch& ccd) {
  const FirstContact touch = ask_first_contact(pair, 0.0, AtStart::kIgnoreTouching, ccd);
  pair.memo->not_contained = touch.state == ContactState::kFree;
  if (touch.state == ContactState::kFree) {
    pair.touching = touch.touched_at_start;
    pair.apart_at_end_mm = touch.distance_mm;
    return;
  }
  pair.near = true;
  pair.undecided = touch.state == ContactState::kUndecided;
  pair.meets = !pair.undecided;
  pair.overlaps_at_start = touch.state == ContactState::kOverlappingAtStart;
  pair.t_contact = touch.touched_at_start ? 0.0 : touch.t_contact;
  pair.t_enter = pair.undecided ? touch.t_clear : touch.t_contact;
  if (world.policy != Policy::kStop) return;
  double t_stop = pair.t_enter;
  if (pair.no_inside())
    t_stop = pair.undecided ? touch.t_clear : 1.0;
  else if (pair.overlaps_at_start)
    t_stop = withdrawal_time(pair, ccd);
  if (!pair.overlaps_at_start)
    pair.memo->allowed_depth_mm = std::numeric_limits<double>::infinity();
  pair.t_stop = pair.tau + (1.0 - pair.tau) * t_stop;
}

// With a band there are two questions: when do they come so near that the real surfaces could meet,
// and when do the meshes meet.
void ask_banded(const World& world, PairWork& pair, CcdScratch& ccd) {
  const FirstContact near = ask_first_contact(pair, pair.band_mm, AtStart::kSay, ccd);
  if (near.state == ContactState::kFree) {
    pair.memo->not_contained = true;
    pair.apart_at_end_mm = std::max(near.distance_mm, pair.band_mm);
    return;
  }
  pair.near = true;
  pair.entered = near.state == ContactState::kContact;
  const FirstContact touch = ask_first_contact(pair, 0.0, AtStart::kSay, ccd);
  pair.memo->not_contained = touch.state == ContactState::kFree;
  pair.undecided =
      near.state == ContactState::kUndecided || touch.state == ContactState::kUndecided;
  pair.meets = touch.state != ContactState::kFree && touch.state != ContactState::kUndecided;
  pair.overlaps_at_start = touch.state == ContactState::kOverlappingAtStart;
  if (pair.meets) pair.t_contact = touch.t_contact;
  pair.t_enter = pair.entered ? near.t_contact : 0.0;
  if (world.policy == Policy::kStop)
    pair.t_stop = pair.tau + (1.0 - pair.tau) * stop_time_with_bands(pair, touch, ccd);
}

}  // namespace

void ask_pair(const World& world, const StepSwitches& switches, PairWork& pair, CcdScratch& ccd) {
  pair.asked = true;
  pair.near = pair.touching = pair.entered = pair.undecided = false;
  pair.meets = pair.overlaps_at_start = pair.blocks = false;
  pair.t_contact = pair.t_stop = 1.0;
  pair.t_enter = pair.apart_at_end_mm = 0.0;
  if (pair.placed) {  // no motion: only how it stands
    pair.near = true;
    return;
  }
  // Does an earlier distance still suffice?
  const BudgetQuery budget{pair.solid_a, pair.solid_b, pair.motion_a, pair.motion_b};
  if (switches.motion_budget &&
      apart_lower_bound_mm(*pair.memo, budget) > pair.band_mm + kClashHysteresis_mm) {
    pair.asked = false;
    return;
  }
  if (pair.plain())
    ask_plain(world, pair, ccd);
  else
    ask_banded(world, pair, ccd);
}

void find_contacts(const World& world, Scratch::Impl& work) {
  work.pool.for_each(work.pair_count, [&](std::size_t i, int thread) {
    ask_pair(world, work.switches, work.pairs[i], work.ccd[static_cast<std::size_t>(thread)]);
  });
}

}  // namespace mortise
