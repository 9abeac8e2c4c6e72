#include "common/session/tick/contacts.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "common/base/constants.h"
#include "common/ccd/start_state.h"
#include "common/session/memory/known_distance.h"
#include "common/session/tick/contact_budget.h"
#include "common/session/tick/depth_budget.h"
#include "common/session/tick/goes_on.h"
#include "common/session/tick/stop_time.h"
#include "common/session/tick/verdicts.h"

namespace mortise {
namespace {

enum class AtStart { kSay, kIgnoreTouching };

// `clear`: how far an earlier question of the same kind got; a touch at the start is looked at
// anew.
FirstContact ask_first_contact(PairWork& pair, double separation_mm, AtStart at_start,
                               double& clear, CcdScratch& ccd) {
  ContactQuery query;
  query.a = pair.ids.solid_a;
  query.b = pair.ids.solid_b;
  query.motion_a = pair.segment.motion_a;
  query.motion_b = pair.segment.motion_b;
  query.separation_mm = separation_mm;
  query.ignore_touching_at_start = at_start == AtStart::kIgnoreTouching;
  query.check_contained = !pair.ids.memo->not_contained;
  query.work_cap = pair.effort.contact_cap;
  query.t_from = clear;
  const FirstContact contact = first_contact(query, ccd);
  note_contact_work(pair, contact.work);
  if (contact.state == ContactState::kUndecided && pair.effort.contact_cap < kCcdWorkCap &&
      contact.work.box_tests + contact.work.leaf_tests >= pair.effort.contact_cap) {
    pair.effort.contact_short = true;
    clear = contact.touched_at_start ? 0.0 : contact.t_clear;
  }
  return contact;
}

// May one lie where the inside of the other is not known? Closed parts cost nothing.
bool is_hidden(const PairWork& pair) {
  const Pose &X_WA = pair.segment.motion_a.X_W1, &X_WB = pair.segment.motion_b.X_W1;
  const BoundingSphere &a = pair.ids.solid_a->sphere(), &b = pair.ids.solid_b->sphere();
  if ((X_WA * a.center_mm - X_WB * b.center_mm).norm() > a.radius_mm + b.radius_mm) return false;
  if (pair.ids.solid_a->inside_known() && pair.ids.solid_b->inside_known()) return false;
  return containment(*pair.ids.solid_a, X_WA, *pair.ids.solid_b, X_WB, kAccuracyDefault_mm) ==
         Containment::kUnknown;
}

// A pair that is hidden is asked anew each tick.
void note_contained(PairWork& pair, bool is_free) {
  pair.status.hidden = is_free && is_hidden(pair);
  is_free = is_free && !pair.status.hidden;
  if (pair.ids.memo->not_contained != is_free) pair.ids.memo.change().not_contained = is_free;
}

// Without a band the parts are their meshes: real is where interiors meet, and first contact says
// when. Touching at the start is no reason to stop anybody; it asks on until the touching places
// press in.
void ask_plain(const World& world, PairWork& pair, CcdScratch& ccd) {
  const FirstContact touch =
      ask_first_contact(pair, 0.0, AtStart::kIgnoreTouching, pair.effort.clear_of_touch, ccd);
  note_contained(pair, touch.state == ContactState::kFree);
  if (touch.state == ContactState::kFree) {
    pair.status.touching = touch.touched_at_start;
    pair.status.apart_at_end_mm = touch.distance_mm;
    return;
  }
  pair.status.near = true;
  pair.status.undecided = touch.state == ContactState::kUndecided;
  pair.answer.meets = !pair.status.undecided;
  pair.answer.overlaps_at_start = touch.state == ContactState::kOverlappingAtStart;
  pair.answer.t_contact = touch.touched_at_start ? 0.0 : touch.t_contact;
  pair.answer.t_enter = pair.status.undecided ? touch.t_clear : touch.t_contact;
  if (!holds_back(world.policy)) return;
  double t_stop = pair.answer.t_enter;
  if (pair.ids.no_inside())
    t_stop = pair.status.undecided ? touch.t_clear : 1.0;
  else if (pair.answer.overlaps_at_start)
    pair.effort.wants_stop_time = true;
  if (!pair.answer.overlaps_at_start && std::isfinite(pair.ids.memo->allowed_depth_mm))
    pair.ids.memo.change().allowed_depth_mm = std::numeric_limits<double>::infinity();
  pair.answer.t_stop = pair.segment.tau + (1.0 - pair.segment.tau) * t_stop;
}

void find_stop_time(PairWork& pair, const FirstContact& touch) {
  const SearchedTime time = stop_time_without_search(pair, touch);
  pair.effort.wants_stop_time = !time.known;
  pair.answer.t_stop = pair.segment.tau + (1.0 - pair.segment.tau) * time.t;
}

// With a band there are two questions: when do they come so near that the real surfaces could meet,
// and when do the meshes meet.
void ask_banded(const World& world, PairWork& pair, CcdScratch& ccd) {
  const FirstContact near =
      ask_first_contact(pair, pair.ids.band_mm, AtStart::kSay, pair.effort.clear_of_band, ccd);
  if (near.state == ContactState::kFree) {
    note_contained(pair, true);
    pair.status.apart_at_end_mm = std::max(near.distance_mm, pair.ids.band_mm);
    return;
  }
  pair.status.near = true;
  pair.answer.entered = near.state == ContactState::kContact;
  const FirstContact touch = ask_touch(pair, ccd);
  pair.status.undecided |= near.state == ContactState::kUndecided;
  pair.answer.t_enter = pair.answer.entered ? near.t_contact : 0.0;
  if (!holds_back(world.policy)) return;
  find_stop_time(pair, touch);
}

// They interfere, or may. Contact of the meshes is asked only where an event is to be told.
void ask_by_covers(const World& world, PairWork& pair) {
  pair.status.near = pair.answer.touch_unasked = true;
  if (!holds_back(world.policy)) return;
  FirstContact touch;
  touch.state = ContactState::kOverlappingAtStart;
  find_stop_time(pair, touch);
}

// Nothing but the meshes can meet.
void ask_never_possible(PairWork& pair, CcdScratch& ccd) {
  const FirstContact touch = ask_touch(pair, ccd);
  pair.status.near = touch.state != ContactState::kFree;
  pair.status.never_real = true;
  if (!pair.status.near) pair.status.apart_at_end_mm = touch.distance_mm;
}

double needed_mm(const PairWork& pair) { return pair.ids.band_mm + kClashHysteresis_mm; }

// Is the pair known to stay clear of everything that has to be looked at? From an earlier distance,
// or else from the distance now where that is likely to save more than it costs.
bool stays_clear(PairWork& pair, CcdScratch& ccd) {
  const MovingPair budget{pair.ids.solid_a, pair.ids.solid_b, pair.segment.motion_a,
                          pair.segment.motion_b};
  if (apart_lower_bound_mm(*pair.ids.memo, budget) > needed_mm(pair)) return true;
  if (pair.effort.contact_cap == 0) return false;
  // Only surfaces are apart: who may start inside the other is asked, and so is who has to end a
  // clash.
  if (!pair.ids.memo->not_contained || pair.ids.open) return false;
  PairMemo& memo = pair.ids.memo.change();
  if (memo.pause > 0) {
    --memo.pause;
    return false;
  }
  // Enough for many ticks like this one, and for parts that hardly move.
  const double spent_mm = relative_travel_upper_bound_mm(budget);
  const double limit_mm =
      2.0 * needed_mm(pair) + 16.0 * spent_mm +
      0.01 * std::min(pair.ids.solid_a->sphere().radius_mm, pair.ids.solid_b->sphere().radius_mm);
  const Pose &X_WA = pair.segment.motion_a.X_W0, &X_WB = pair.segment.motion_b.X_W0;
  const double apart_mm = pair_distance(pair, X_WA, X_WB, limit_mm, ccd).distance_mm;
  remember_apart(memo, X_WA, X_WB, apart_mm);
  if (apart_mm - needed_mm(pair) < 4.0 * spent_mm) {
    memo.pause = memo.next_pause;
    memo.next_pause = static_cast<std::uint8_t>(std::min(64, 2 * memo.next_pause));
  } else {
    memo.next_pause = 1;
  }
  return apart_lower_bound_mm(memo, budget) > needed_mm(pair);
}

}  // namespace

DistanceResult pair_distance(PairWork& pair, const Pose& X_WA, const Pose& X_WB, double limit_mm,
                             CcdScratch& ccd) {
  ++pair.effort.counts.distance_queries;
  const DistanceResult result = distance(*pair.ids.solid_a, X_WA, *pair.ids.solid_b, X_WB, ccd,
                                         limit_mm, &pair.ids.memo->nearest);
  if (result.within_limit) pair.ids.memo.change().nearest = result;
  return result;
}

FirstContact ask_touch(PairWork& pair, CcdScratch& ccd) {
  const FirstContact touch =
      ask_first_contact(pair, 0.0, AtStart::kSay, pair.effort.clear_of_touch, ccd);
  note_contained(pair, touch.state == ContactState::kFree);
  pair.answer.touch_unasked = false;
  pair.status.undecided |= touch.state == ContactState::kUndecided;
  pair.answer.meets = touch.state != ContactState::kFree && touch.state != ContactState::kUndecided;
  pair.answer.overlaps_at_start = touch.state == ContactState::kOverlappingAtStart;
  if (pair.answer.meets) pair.answer.t_contact = touch.t_contact;
  return touch;
}

void note_contact_work(PairWork& pair, const CcdWork& work) {
  ++pair.effort.counts.first_contact_queries;
  pair.effort.counts.box_tests += work.box_tests;
  pair.effort.counts.triangle_tests += work.triangle_tests;
  pair.effort.contact_tests += work.box_tests + work.leaf_tests;
}

namespace {

// Pushed on where it is told that it is held: by the place that has held it before, without any
// other question. Under slide what holds a part is looked at anew for each leg.
bool stays_held(const World& world, PairWork& pair) {
  if (world.policy != Policy::kStop || pair.ids.plain() || pair.ids.no_inside() ||
      !is_told_real(pair) || !is_held_again(pair))
    return false;
  ++pair.effort.counts.pairs_held_again;
  pair.status.near = pair.status.held_again = true;
  pair.answer.t_stop = pair.segment.tau;
  return true;
}

// Something is told of the pair, and covers prove that it goes on, or else how far the pair goes
// before it is real.
bool go_on(const World& world, PairWork& pair, CcdScratch& ccd) {
  pair.status.goes_on = goes_on(pair, ccd);
  if (!pair.status.goes_on && !holds_back(world.policy)) return false;
  if (!pair.status.goes_on) {
    ask_by_covers(world, pair);
    return true;
  }
  pair.status.near = pair.answer.touch_unasked = pair.status.never_real = true;
  ++pair.effort.counts.pairs_held_again;
  return true;
}

// The tick has no work left for it. It goes as far as covers prove at once that nothing is certain:
// who leaves a wall, or slides along it, is not held by what others need.
void leave_unasked(const World& world, PairWork& pair) {
  pair.status.near = pair.status.undecided = pair.effort.contact_waits = true;
  if (!holds_back(world.policy)) return;
  const double t = free_by_covers(pair);
  pair.status.never_real = t >= 1.0 && pair.answer.certain_free->closely;
  pair.answer.short_of_work = t < 1.0;
  pair.answer.t_stop = pair.segment.tau + (1.0 - pair.segment.tau) * t;
}

void ask_pair(const World& world, const StepSwitches& switches, PairWork& pair, CcdScratch& ccd) {
  pair.status.asked = true;
  pair.status.near = pair.status.touching = pair.answer.entered = pair.status.undecided = false;
  pair.answer.meets = pair.answer.overlaps_at_start = pair.status.blocks = false;
  pair.answer.t_contact = pair.answer.t_stop = 1.0;
  pair.status.never_real = pair.status.held_again = pair.effort.wants_stop_time = false;
  pair.answer.stop_gave_up = pair.answer.short_of_work = pair.effort.stalled =
      pair.status.withdrawal_unsure = false;
  pair.answer.place = {};
  pair.answer.certain_free.reset();
  pair.answer.t_enter = pair.status.apart_at_end_mm = 0.0;
  pair.effort.contact_waits = pair.status.goes_on = pair.answer.touch_unasked = false;
  const bool cut_short = std::exchange(pair.effort.contact_short, false);
  if (pair.status.together) {
    pair.status.asked = false;
    return;
  }
  if (pair.ids.placed) {  // no motion: only how it stands
    pair.status.near = true;
    return;
  }
  if (switches.known_distances && !cut_short && stays_clear(pair, ccd)) {
    pair.status.asked = false;
    return;
  }
  if (switches.held_places && stays_held(world, pair)) return;
  if (switches.told_goes_on && may_go_on(world, pair) && go_on(world, pair, ccd)) return;
  if (pair.effort.contact_cap == 0) return leave_unasked(world, pair);
  if (pair.ids.plain())
    ask_plain(world, pair, ccd);
  else if (switches.told_goes_on && !pair.ids.open && is_never_possible(pair))
    ask_never_possible(pair, ccd);
  else if (switches.told_goes_on && is_possible_at_end(pair))
    ask_by_covers(world, pair);
  else
    ask_banded(world, pair, ccd);
  pair.answer.short_of_work = pair.effort.contact_short;
  // First contact sometimes learns how far apart they end.
  if (!pair.status.near && !pair.status.touching && pair.status.apart_at_end_mm > needed_mm(pair))
    remember_apart(pair.ids.memo.change(), pair.segment.motion_a.X_W1, pair.segment.motion_b.X_W1,
                   pair.status.apart_at_end_mm);
}

// What is known of the stop without a search stands where there is no work left for one.
void search_stop_time(PairWork& pair, bool slides, CcdScratch& ccd) {
  if (pair.effort.cap == 0) {
    pair.status.undecided = pair.answer.stop_gave_up = true;
    pair.effort.stalled = is_stalled(pair) && pair.ids.memo->stalled->in_full;
    pair.answer.short_of_work |= !pair.effort.stalled;
    return;
  }
  const bool was_undecided = std::exchange(pair.status.undecided, false);
  const double t =
      pair.ids.plain() ? withdrawal_time(pair, ccd) : stop_time_with_bands(pair, slides, ccd);
  pair.answer.t_stop = pair.segment.tau + (1.0 - pair.segment.tau) * t;
  note_depth_effort(pair, WorkStage::kStop, pair.status.undecided);
  pair.answer.stop_gave_up = pair.status.undecided;
  // Real for certain a little later: all that is open is how far the pair might still go.
  if (!slides && pair.answer.place.known()) pair.status.undecided = false;
  pair.answer.short_of_work |= pair.status.undecided && pair.effort.may_have_more();
  note_stalled(pair);
  pair.status.undecided |= was_undecided;
}

}  // namespace

void ask_pairs(const World& world, Scratch::Impl& work, std::span<const std::uint32_t> pairs) {
  ask_in_turn(world, work, pairs,
              [&](PairWork& pair, CcdScratch& ccd) { ask_pair(world, work.switches, pair, ccd); });
  work.asked.clear();
  for (const std::uint32_t i : pairs)
    if (work.pairs[i].effort.wants_stop_time) work.asked.push_back(i);
  if (work.asked.empty()) return;
  const bool slides = world.policy == Policy::kSlide;
  serve_in_turn(world, work, work.asked, WorkStage::kStop,
                [&](PairWork& pair, CcdScratch& ccd) { search_stop_time(pair, slides, ccd); });
}

void find_contacts(const World& world, Scratch::Impl& work) {
  work.to_ask.resize(work.pair_count);
  std::iota(work.to_ask.begin(), work.to_ask.end(), 0U);
  ask_pairs(world, work, work.to_ask);
}

}  // namespace mortise
