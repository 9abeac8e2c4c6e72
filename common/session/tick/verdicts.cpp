#include "common/session/tick/verdicts.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>

#include "common/base/constants.h"
#include "common/session/tick/clash_identity.h"
#include "common/session/tick/contact_budget.h"
#include "common/session/tick/contacts.h"
#include "common/session/tick/depth_budget.h"
#include "common/session/tick/event_times.h"
#include "common/session/tick/goes_on.h"

namespace mortise {
namespace {

// Evaluations of one overlap within a tick at most, whatever work there is. A pair at the very
// brink of a threshold can take any number; where it ends, brackets stay wide. Without a witness
// the verdict is potential then, and the pair is counted as not examined to the end.
constexpr std::uint64_t kTickOverlapCap = 10'000;
// Tests of the look back from the end of a motion that passes through something.
constexpr std::uint64_t kLeastWorkBack = 2'000;

// The two motions of a pair over some part of the tick; t_contact and t_enter (see PairWork) count
// in them, 1: not within them.
struct SegmentMotion {
  Motion a, b;
  double t_contact = 1.0, t_enter = 0.0;
};

SegmentMotion as_asked(const PairWork& pair) {
  return {pair.segment.motion_a, pair.segment.motion_b, pair.answer.t_contact, pair.answer.t_enter};
}

SeenRegion seen_at(const Verdict& verdict, const Pose& X_WA, const Pose& X_WB) {
  SeenRegion seen;
  seen.verdict = verdict;
  seen.p_A = X_WA.inverse() * verdict.point_W;
  seen.p_B = X_WB.inverse() * verdict.point_W;
  return seen;
}

JudgementQuery query_at_end(const World& world, const PairWork& pair, const SegmentMotion& motion) {
  JudgementQuery query;
  query.a = &world.parts[pair.ids.a];
  query.b = &world.parts[pair.ids.b];
  query.rule = pair.ids.rule;
  query.motion_a = motion.a;
  query.motion_b = motion.b;
  query.t_contact = motion.t_contact;
  query.want_gpd = false;
  if (pair.judged.in_full) query.refinement = Refinement::kFull;
  query.work_cap = query.whole_cap = pair.effort.cap_of(kTickOverlapCap);
  return query;
}

// Nothing that is left to look at can change its class.
bool is_certain(const OverlapRegion& region) {
  return region.has_witness && region.certain_mm.lo > 0.0;
}

Judgement judge(PairWork& pair, const JudgementQuery& query, CcdScratch& ccd) {
  Judgement judgement = judge_pair(query, ccd);
  count(query, judgement, pair.effort.counts);
  for (const OverlapRegion& region : judgement.overlap.regions)
    if (region.capped && !is_certain(region)) pair.status.undecided = true;
  return judgement;
}

void judge_at_end(const World& world, PairWork& pair, const SegmentMotion& motion,
                  CcdScratch& ccd) {
  pair.judged.query = query_at_end(world, pair, motion);
  pair.judged.judgement = judge(pair, pair.judged.query, ccd);
  for (std::size_t i = 0; i < pair.judged.judgement.verdicts.size(); ++i) {
    pair.judged.seen.push_back(
        seen_at(pair.judged.judgement.verdicts[i], motion.a.X_W1, motion.b.X_W1));
    pair.judged.seen.back().of_judgement = static_cast<int>(i);
  }
}

double share_of(double t, double end) { return end > 0.0 ? std::min(1.0, t / end) : 1.0; }

// Both motions up to time t of their own.
SegmentMotion up_to(const SegmentMotion& motion, double t) {
  return {until(motion.a, t), until(motion.b, t), share_of(motion.t_contact, t),
          share_of(motion.t_enter, t)};
}

// What the response left of the segment of one part.
Motion as_moved(const Scratch::Impl& work, std::int32_t index, const Motion& segment, double tau) {
  if (index < 0) return segment;
  const Move& move = work.moves[static_cast<std::size_t>(index)];
  if (!move.stopped) return segment;
  Motion cut = until(segment, (move.stop - tau) / (1.0 - tau));
  if (!cut.moves()) cut.X_W0 = move.X_WP_end;
  cut.X_W1 = move.X_WP_end;
  return cut;
}

// Time of the tick up to which a part of the pair moves.
double end_of(const Scratch::Impl& work, const PairWork& pair) {
  double end = pair.segment.tau;
  for (const std::int32_t index : {pair.ids.move_a, pair.ids.move_b})
    if (index >= 0) end = std::max(end, work.moves[static_cast<std::size_t>(index)].stop);
  return end;
}

SegmentMotion as_moved(const Scratch::Impl& work, const PairWork& pair) {
  if (pair.status.t_left < 1.0)
    return up_to(as_asked(pair),
                 (pair.status.t_left - pair.segment.tau) / (1.0 - pair.segment.tau));
  SegmentMotion motion = as_asked(pair);
  motion.a = as_moved(work, pair.ids.move_a, pair.segment.motion_a, pair.segment.tau);
  motion.b = as_moved(work, pair.ids.move_b, pair.segment.motion_b, pair.segment.tau);
  const double local_end = (end_of(work, pair) - pair.segment.tau) / (1.0 - pair.segment.tau);
  motion.t_contact = share_of(pair.answer.t_contact, local_end);
  motion.t_enter = pair.answer.t_enter > 0.0 ? share_of(pair.answer.t_enter, local_end) : 0.0;
  return motion;
}

Motion backward(const Motion& motion) {
  if (!motion.moves()) return motion;
  return linear_motion(motion.X_W1, motion.X_W0, motion.reference_P);
}

void prefix(Verdict& verdict, const char* what, double t) {
  char text[80];
  std::snprintf(text, sizeof text, "%s at t = %.4f: ", what, t);
  verdict.explanation.insert(0, text);
}

// The parts meet within the segment but nothing is seen at its end: they passed each other, through
// or by. Looks inside the interval between the first and the last contact, whose ends are known to
// the accuracy of first contact however thin the wall; middle first.
std::optional<SeenRegion> passing(const World& world, PairWork& pair, const SegmentMotion& whole,
                                  CcdScratch& ccd) {
  ContactQuery back;
  back.a = pair.ids.solid_a;
  back.b = pair.ids.solid_b;
  back.motion_a = backward(whole.a);
  back.motion_b = backward(whole.b);
  back.separation_mm = pair.ids.band_mm;
  back.check_contained = false;
  back.ignore_touching_at_start = pair.ids.plain();
  back.work_cap = std::max(pair.effort.contact_cap, kLeastWorkBack);
  const FirstContact last = first_contact(back, ccd);
  note_contact_work(pair, last.work);
  if (last.state == ContactState::kUndecided) pair.status.undecided = true;
  const double t_out = std::max(whole.t_enter, 1.0 - last.t_clear);
  for (const double share : {0.5, 0.25, 0.75, 0.125, 0.375, 0.625, 0.875}) {
    if (pair.effort.left() == 0) {
      pair.status.undecided = true;
      break;
    }
    const double t = whole.t_enter + share * (t_out - whole.t_enter);
    const SegmentMotion there = up_to(whole, t);
    JudgementQuery query = query_at_end(world, pair, there);
    query.want_gpd = true;
    const Judgement judgement = judge(pair, query, ccd);
    if (judgement.verdicts.empty()) continue;
    SeenRegion region = seen_at(judgement.verdicts.front(), there.a.X_W1, there.b.X_W1);
    prefix(region.verdict, "worst found", pair.segment.tau + (1.0 - pair.segment.tau) * t);
    return region;
  }
  return std::nullopt;
}

// The collision that made the response stop this pair, judged where the increments would have led.
// Where the part was stopped it stands at the very brink of being real: nothing is to be learned
// there.
void look_at_attempt(const World& world, PairWork& pair, CcdScratch& ccd) {
  const SegmentMotion asked = as_asked(pair);
  judge_at_end(world, pair, asked, ccd);
  for (const OverlapRegion& region : pair.judged.judgement.overlap.regions)
    if (!pair.answer.place.known()) pair.answer.place = region.certain_place;
  if (pair.judged.seen.empty() ||
      pair.judged.seen.front().verdict.collision_class != CollisionClass::kReal) {
    pair.judged.seen.clear();
    if (auto region = passing(world, pair, asked, ccd))
      pair.judged.seen.push_back(std::move(*region));
  }
  for (SeenRegion& seen : pair.judged.seen) prefix(seen.verdict, "stopped", pair.answer.t_stop);
}

bool is_stopped(const Scratch::Impl& work, std::int32_t move) {
  return move >= 0 && work.moves[static_cast<std::size_t>(move)].stopped;
}

// What is told is proven to go on to the end of the tick; or the place that holds a part is one
// that is told, or holds it again; or the same push comes to nothing again.
bool stays_told(const World& world, const Scratch::Impl& work, const PairWork& pair) {
  if (pair.ids.memo->not_judged) return false;
  if (pair.status.blocks && pair.effort.stalled) return pair.ids.memo->stalled->judged;
  if (!pair.status.near) return false;
  if (!pair.status.blocks) return pair.status.goes_on;
  return (pair.status.held_again && is_told_real(pair)) ||
         (work.switches.told_goes_on && is_told_there(world, pair));
}

// What is told holds to the end of the tick only where nobody was stopped before. Else, and where a
// class is perhaps left, the pair is looked at if there is work, and told to go on if not.
void note_going_on(const World& world, const Scratch::Impl& work, PairWork& pair) {
  const bool stopped = is_stopped(work, pair.ids.move_a) || is_stopped(work, pair.ids.move_b);
  pair.status.goes_on &= pair.status.near && !pair.status.blocks && !stopped;
  pair.status.lingers = !pair.status.goes_on && pair.status.near && !pair.status.blocks &&
                        !stopped && work.switches.told_goes_on && lingers(world, pair);
}

// Nobody looked: the open clashes stay as they are. What is proven to go on is looked at once its
// parts rest.
void keep_told(PairWork& pair) {
  pair.judged.seen.clear();
  pair.judged.judgement = {};
  if (pair.ids.open) pair.judged.keeps.assign(pair.ids.open->size(), 1);
  pair.status.owed |= pair.status.goes_on || pair.status.lingers;
}

void look_at_pair(const World& world, const Scratch::Impl& work, PairWork& pair, CcdScratch& ccd) {
  const SegmentMotion motion = as_moved(work, pair);
  pair.judged.seen.clear();
  pair.judged.unsettled = false;
  if (pair.status.blocks) {
    look_at_attempt(world, pair, ccd);
  } else {
    judge_at_end(world, pair, motion, ccd);
    if (pair.judged.seen.empty() && pair.answer.touch_unasked) ask_touch(pair, ccd);
    if (pair.judged.seen.empty() &&
        (pair.answer.entered || (pair.answer.meets && !pair.answer.overlaps_at_start)))
      if (auto region = passing(world, pair, motion, ccd)) {
        region->passing = true;
        pair.judged.seen.push_back(std::move(*region));
      }
  }
  if (pair.status.t_left < 1.0)
    for (SeenRegion& seen : pair.judged.seen) seen.passing = true;
  double distance_mm = kInfinity;
  if (pair.ids.open && pair.judged.judgement.overlap.regions.empty()) {
    const DistanceResult result =
        pair_distance(pair, motion.a.X_W1, motion.b.X_W1,
                      2.0 * (pair.ids.band_mm + kClashHysteresisMost_mm), ccd);
    if (result.within_limit) distance_mm = result.distance_mm;
  }
  match_clashes(world, pair, distance_mm);
}

void note_seen(PairWork& pair) {
  if (!pair.ids.memo->not_judged && !pair.ids.memo->not_seen) return;
  PairMemo& memo = pair.ids.memo.change();
  memo.not_judged = memo.not_seen = false;
}

// Clear of the band, but an open clash ends only at some distance.
void look_at_clear_pair(const World& world, const Scratch::Impl& work, PairWork& pair,
                        CcdScratch& ccd) {
  pair.judged.seen.clear();
  pair.judged.judgement = {};
  const SegmentMotion motion = as_moved(work, pair);
  const DistanceResult result = pair_distance(
      pair, motion.a.X_W1, motion.b.X_W1, 2.0 * (pair.ids.band_mm + kClashHysteresisMost_mm), ccd);
  match_clashes(world, pair, result.within_limit ? result.distance_mm : kInfinity);
  note_seen(pair);
}

void take_depth(const Verdict& from, Verdict& to) {
  to.gpd_mm = from.gpd_mm;
  to.travel_mm = from.travel_mm;
  to.normal_travel_mm = from.normal_travel_mm;
  to.separation_translation_mm = from.separation_translation_mm;
  to.separation_rotation_rad = from.separation_rotation_rad;
  to.separation_about_W = from.separation_about_W;
  to.separation_of_b = from.separation_of_b;
  to.separation_way = from.separation_way;
}

bool anything_to_tell(const PairWork& pair) {
  return std::any_of(pair.judged.seen.begin(), pair.judged.seen.end(),
                     [](const SeenRegion& seen) { return seen.tell; });
}

// A verdict that was cut short is discarded. The next ticks judge the pair again, at its present
// poses if the parts rest. There the contact that stopped a part cannot be seen, so the clashes
// that are told stay.
void put_off(PairWork& pair) {
  keep_told(pair);
  if (pair.status.lingers) return;
  pair.status.undecided = true;
  pair.status.owed = !pair.status.blocks || !pair.ids.open;
}

// After a decision: what was open is judged by what holds now, and as the parts stand.
void note_judged(PairWork& pair) {
  if (!pair.status.blocks) return note_seen(pair);
  if (pair.ids.memo->not_judged) pair.ids.memo.change().not_judged = false;
}

// A class was left, but perhaps only because no more was asked than what class it is now. While
// parts move that may be; when they rest it is asked once.
void settle(const World& world, const Scratch::Impl& work, PairWork& pair, CcdScratch& ccd) {
  if (!pair.judged.unsettled || pair.status.blocks) return;
  if (!pair.ids.placed) {
    pair.status.owed = true;
    return;
  }
  pair.judged.in_full = true;
  look_at_pair(world, work, pair, ccd);
}

void examine(const World& world, const Scratch::Impl& work, PairWork& pair, CcdScratch& ccd) {
  if (pair.effort.cap == 0) {
    put_off(pair);
    return;
  }
  const bool was_undecided = std::exchange(pair.status.undecided, false);
  look_at_pair(world, work, pair, ccd);
  settle(world, work, pair, ccd);
  const bool capped = pair.status.undecided;
  if (capped && pair.effort.may_have_more()) {
    put_off(pair);
  } else {
    pair.judged.tells = anything_to_tell(pair);
    note_judged(pair);
  }
  if (pair.status.blocks && !pair.status.owed && pair.ids.memo->stalled)
    pair.ids.memo.change().stalled->judged = true;
  note_depth_effort(pair, WorkStage::kVerdict, capped);
  pair.status.undecided |= was_undecided;
}

// Contact, times and the separating motion are needed only where somebody is told of them.
void complete(const Scratch::Impl& work, PairWork& pair, CcdScratch& ccd) {
  if (pair.answer.touch_unasked) {
    ask_touch(pair, ccd);
    pair.judged.query.t_contact =
        (pair.status.blocks ? as_asked(pair) : as_moved(work, pair)).t_contact;
  }
  find_event_times(pair, end_of(work, pair), ccd);
  const std::uint64_t looked = pair.judged.judgement.overlap.evaluations;
  pair.judged.query.whole_cap = looked + pair.effort.left();
  add_depths(pair.judged.query, pair.judged.judgement, ccd);
  pair.effort.counts.depth_evaluations += pair.judged.judgement.overlap.evaluations - looked;
  for (SeenRegion& seen : pair.judged.seen)
    if (seen.of_judgement >= 0)
      take_depth(pair.judged.judgement.verdicts[static_cast<std::size_t>(seen.of_judgement)],
                 seen.verdict);
}

}  // namespace

bool is_told_real(const PairWork& pair) {
  return !pair.ids.memo->not_judged && pair.ids.open &&
         std::any_of(pair.ids.open->begin(), pair.ids.open->end(), [](const OpenClash& clash) {
           return clash.now.collision_class == CollisionClass::kReal;
         });
}

void find_verdicts(const World& world, Scratch::Impl& work) {
  work.asked.clear();
  work.unasked.clear();
  work.pool.for_each(work.pair_count, [&](std::size_t i, int) {
    work.pairs[i].judged.tells = false;
    if (work.pairs[i].status.asked) note_going_on(world, work, work.pairs[i]);
  });
  for (std::uint32_t i = 0; i < work.pair_count; ++i) {
    PairWork& pair = work.pairs[i];
    if (!pair.status.asked) continue;
    // A part that was stopped before this pair came near is clear of it.
    const bool looked_at = pair.status.near && (pair.ids.placed || pair.status.blocks ||
                                                as_moved(work, pair).t_enter < 1.0);
    // Who was held back only because there was no work to let it go on has met nothing yet.
    if (looked_at && pair.status.blocks && pair.answer.short_of_work)
      put_off(pair);
    else if (looked_at)
      (stays_told(world, work, pair) ? work.unasked : work.asked).push_back(i);
    else if (pair.ids.open)
      work.unasked.push_back(i);
  }
  work.pool.for_each(work.unasked.size(), [&](std::size_t i, int thread) {
    PairWork& pair = work.pairs[work.unasked[i]];
    if (stays_told(world, work, pair))
      keep_told(pair);
    else
      look_at_clear_pair(world, work, pair, work.ccd[static_cast<std::size_t>(thread)]);
  });
  share_touch_work(work, work.asked);
  serve_in_turn(world, work, work.asked, WorkStage::kVerdict,
                [&](PairWork& pair, CcdScratch& ccd) { examine(world, work, pair, ccd); });
  std::erase_if(work.asked, [&](std::uint32_t i) { return !work.pairs[i].judged.tells; });
  share_telling_work(work, work.asked);
  share_touch_work(work, work.asked);
  work.pool.for_each(work.asked.size(), [&](std::size_t i, int thread) {
    complete(work, work.pairs[work.asked[i]], work.ccd[static_cast<std::size_t>(thread)]);
  });
  for (std::size_t i = 0; i < work.pair_count; ++i) {
    PairWork& pair = work.pairs[i];
    pair.status.owed |= pair.status.asked && pair.ids.open && pair.ids.memo->not_seen;
  }
}

}  // namespace mortise
