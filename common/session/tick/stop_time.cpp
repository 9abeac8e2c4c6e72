#include "common/session/tick/stop_time.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/constants.h"
#include "common/depth/depth.h"
#include "common/session/memory/known_distance.h"
#include "common/session/tick/pair_queries.h"

namespace mortise {
namespace {

// Evaluations of one search for the time at which a pair becomes real, some 30 ms of work. Where it
// ends the search the mover is left at the time proven so far and the pair is counted as not
// examined; larger holds up everybody for one pair.
constexpr std::uint64_t kRealTimeWorkCap = 10'000;

// Evaluations of one look at the depth on the way; where it ends, the bracket is wide and the look
// is worth nothing.
constexpr std::uint64_t kLookWorkCap = 2'000;
// The same of a look at what is withdrawn: the shafts of the demo need 1,100. Where it ends, the
// depth is told too small; the pair is counted as not examined.
constexpr std::uint64_t kWithdrawalLookWorkCap = 2'000;
// The same of the depth in the tick in which a withdrawal begins, where that look does not find it.
constexpr std::uint64_t kWithdrawalStartWorkCap = 20 * kWithdrawalLookWorkCap;
// The same of how deep parts lie in each other; where it ends, that is told too small, and may hold
// a part that would become deeper on its way out.
constexpr std::uint64_t kInnerWorkCap = 600;

// How closely the advance approaches the time at which the pair becomes real, mm of depth, and the
// steps it may take: head-on it needs two or three; a part that slides along at constant depth
// needs many and is left to the search.
constexpr double kAdvanceAccuracy_mm = 0.5 * kDepthAccuracyDefault_mm;
constexpr int kAdvanceSteps = 12;
// A part that is real within so much of its path stays where it stands. mm; the first is what the
// search for the time is content with, too.
constexpr double kHeldPaths_mm[] = {0.02, 0.004, 0.0008};
// The same where the search had to give up: nothing closer is known of the stop anyway.
constexpr double kHeldAfterGivingUp_mm[] = {0.2, 0.06};
// Motions from the same place whose directions have a larger cosine are one push.
constexpr double kSamePushCosine = 0.95;
// Parts that approach by less than this share of their speed slide.
constexpr double kLeastApproach = 0.1;
// Path by which a part leaves the brink of being real, mm.
constexpr double kLeaveBrink_mm = 0.05;
static_assert(4.0 * kAdvanceAccuracy_mm <= kClashHysteresis_mm);

// Upper bound of the lower outward offset of any face: what the real surface has at least.
double largest_lower_offset_mm(const SurfaceBand& band) {
  double largest = 0.0;
  for (const SurfaceBand::Face& face : band.faces) {
    // With a surface the deviation is e(x) +- residual, and e + residual + tolerance.hi is at most
    // the largest offset of the band.
    const double lower = face.surface ? band.largest_offset_mm - face.tolerance_mm.width()
                                      : face.deviation_mm.lo + face.tolerance_mm.lo;
    largest = std::max(largest, lower);
  }
  return largest;
}

// Lower bound of what any face may have at most beyond what it has at least.
double narrowest_mm(const SurfaceBand& band) {
  double narrowest = std::numeric_limits<double>::infinity();
  for (const SurfaceBand::Face& face : band.faces)
    narrowest = std::min(
        narrowest, face.tolerance_mm.width() + (face.surface ? 0.0 : face.deviation_mm.width()));
  return std::max(0.0, narrowest);
}

// Upper bound of the certain depth of a place that an overlap does not speak of: it is not even
// possible there.
double elsewhere_mm(const PairWork& pair) {
  return -narrowest_mm(*pair.ids.band_a) - narrowest_mm(*pair.ids.band_b);
}

// Bracket of the deepest overlap that is certain at one time of the segment, mm.
struct Look {
  Interval depth_mm;
  bool capped = false;
  bool witnessed = false;  // some point is in both parts for certain
  bool has_place = false;  // where the deepest region lies, world frame, and its normal from B to A
  Vec3 point_W = Vec3::Zero(), normal_W = Vec3::UnitZ();
};

constexpr double kAll = -kInfinity;

// What is no deeper than ignore_below_mm is only known to be so.
Look certain_depth(PairWork& pair, double t, double accuracy_mm, Refinement refinement,
                   double ignore_below_mm, std::uint64_t work_cap, CcdScratch& ccd) {
  OverlapQuery query = overlap_query(pair, t);
  query.refinement = refinement;
  query.accuracy_mm = accuracy_mm;
  // A withdrawal is compared with the least certain depth: an unfinished search would let the part
  // go deeper.
  query.only_certain = refinement == Refinement::kFull;
  query.ignore_below_mm = ignore_below_mm;
  query.work_cap = work_cap;
  query.prove_not_certain = true;
  query.want_delta = pair.ids.band_a->trivial && pair.ids.band_b->trivial;
  const OverlapResult overlap = find_overlap(query, ccd);
  ++pair.effort.counts.depth_queries;
  pair.effort.counts.depth_evaluations += overlap.evaluations;
  Look look;
  look.depth_mm = {elsewhere_mm(pair), elsewhere_mm(pair)};
  for (const OverlapRegion& region : overlap.regions) {
    look.capped |= region.capped;
    look.witnessed |= region.has_witness;
    look.depth_mm.lo = std::max(look.depth_mm.lo, region.certain_mm.lo);
    if (region.certain_mm.hi < look.depth_mm.hi) continue;
    look.depth_mm.hi = region.certain_mm.hi;
    look.has_place = true;
    look.point_W = region.point_W;
    look.normal_W = region.normal_W;
  }
  return look;
}

// Do the parts slide past each other at the place, rather than approach? mm a segment.
bool slides(const PairWork& pair, const Look& look, double t, double speed_mm) {
  if (!look.has_place) return false;
  const auto end = [&](const Motion& motion) -> Vec3 {
    return motion.X_W1 * (motion.pose_at(t).inverse() * look.point_W);
  };
  const double approach_mm =
      -look.normal_W.dot(end(pair.segment.motion_a) - end(pair.segment.motion_b));
  return approach_mm < kLeastApproach * (1.0 - t) * speed_mm;
}

enum class Advanced { kDone, kRealAtStart, kUnsure };

struct Advance {
  Advanced state = Advanced::kUnsure;
  double t_free = 0.0;
};

// The depth that is certain changes no faster than the parts move against each other: where it
// lacks g, no motion of less than g makes it real (depth/README.md, section 6).
//   1. depth at t; not below zero for certain: the last t was the last one proven.
//   2. go on by as much time as the parts need for that depth.
Advance advance_to_real(PairWork& pair, double t_start, CcdScratch& ccd) {
  const double speed_mm = relative_travel_upper_bound_mm(
      {pair.ids.solid_a, pair.ids.solid_b, pair.segment.motion_a, pair.segment.motion_b});
  Advance advance;
  double t = advance.t_free = t_start;
  for (int i = 0; i < kAdvanceSteps; ++i) {
    const Look look = certain_depth(pair, t, kAdvanceAccuracy_mm, Refinement::kDecided, kAll,
                                    pair.effort.cap_of(kLookWorkCap), ccd);
    const Interval& depth_mm = look.depth_mm;
    if (look.witnessed && t == 0.0) {
      advance.state = Advanced::kRealAtStart;
      return advance;
    }
    if (depth_mm.hi > 0.0) return advance;
    advance.t_free = t;
    const double lacking_mm = -depth_mm.hi;
    if (lacking_mm <= kAdvanceAccuracy_mm) {
      // Reached it, when the bracket is tight as well; whether a part may slide along at the limit
      // is for the search to say.
      if (i > 0 && depth_mm.lo >= -4.0 * kAdvanceAccuracy_mm) advance.state = Advanced::kDone;
      return advance;
    }
    t += lacking_mm / speed_mm;
    if (t < 1.0 && slides(pair, look, advance.t_free, speed_mm)) return advance;
    if (!(t < 1.0)) {
      advance = {Advanced::kDone, 1.0};
      return advance;
    }
  }
  return advance;
}

Look withdrawal_look(PairWork& pair, double t, double ignore_below_mm, CcdScratch& ccd,
                     std::uint64_t work_cap = kWithdrawalLookWorkCap) {
  return certain_depth(pair, t, kDeepeningSlack_mm, Refinement::kFull, ignore_below_mm, work_cap,
                       ccd);
}

// How deep a withdrawn pair is for certain. Parts that lie deep in each other may become deeper at
// their surfaces on the way out, so that what they have inside counts: in their meshes, less what
// the least surfaces lie below them. Infinite where that is not found in a later tick: then what
// was found in the first one holds on.
double depth_at_start_mm(PairWork& pair, CcdScratch& ccd) {
  const bool begins = !std::isfinite(pair.ids.memo->allowed_depth_mm);
  Look look = withdrawal_look(pair, 0.0, kAll, ccd);
  if (look.capped && begins) look = withdrawal_look(pair, 0.0, kAll, ccd, kWithdrawalStartWorkCap);
  pair.status.withdrawal_unsure |= look.capped;
  if (look.capped && !begins) return kInfinity;
  // A look that is unfinished even so has found too little, and would hold the part.
  const double depth_mm = std::max(0.0, look.capped ? look.depth_mm.hi : look.depth_mm.lo);
  if (!look.has_place || pair.ids.no_inside()) return depth_mm;
  return certain_depth_inside_mm(overlap_query(pair, 0.0), look.point_W, depth_mm, kInnerWorkCap,
                                 pair.effort.counts.depth_evaluations);
}

// Up to the time t_most at the latest.
double withdrawal_until(PairWork& pair, double t_most, CcdScratch& ccd) {
  // Between two looks the depth may have grown and shrunk again; a quarter of a tick is short.
  constexpr int kLooks = 4;
  double& allowed_mm = pair.ids.memo.change().allowed_depth_mm;
  allowed_mm = std::min(allowed_mm, depth_at_start_mm(pair, ccd));
  // The less it interferes, the less it may gain: what one tick grants must not be the licence of
  // the next.
  const double slack_mm = std::clamp(allowed_mm, 10.0 * kAccuracyDefault_mm, kDeepeningSlack_mm);
  const double most_mm = allowed_mm + slack_mm;
  int free = 0;
  for (int i = 1; i <= kLooks; ++i) {
    const Look look = withdrawal_look(pair, t_most * i / kLooks, most_mm, ccd);
    pair.status.withdrawal_unsure |= look.capped;
    if (look.depth_mm.lo > most_mm) return t_most * free / kLooks;
    free = i;
    // Where one look is not finished, those between it and the end are not either.
    if (look.capped) i = std::max(i, kLooks - 1);
  }
  return t_most;
}

// A part that has been drawn out until both just touch is not real, but no search can prove for how
// long. It continues its motion by a step so small that nothing can be missed between two checks.
// From there it is searched like any other.
double leave_brink(PairWork& pair, CcdScratch& ccd) {
  const double speed_mm = relative_travel_upper_bound_mm(
      {pair.ids.solid_a, pair.ids.solid_b, pair.segment.motion_a, pair.segment.motion_b});
  return withdrawal_until(pair, std::min(1.0, kLeaveBrink_mm / speed_mm), ccd);
}

PairMemo::Stalled push_of(const PairWork& pair) {
  const double rim_mm =
      std::min(pair.ids.solid_a->sphere().radius_mm, pair.ids.solid_b->sphere().radius_mm);
  return {pair.segment.motion_a.X_W0,
          pair.segment.motion_b.X_W0,
          pair.segment.motion_a.v_W - pair.segment.motion_b.v_W,
          rim_mm * (pair.segment.motion_a.w_W - pair.segment.motion_b.w_W),
          false,
          false,
          0};
}

SearchedTime start_of_search(PairWork& pair, const FirstContact& touch) {
  double t_start = pair.answer.t_enter;
  if (largest_lower_offset_mm(*pair.ids.band_a) + largest_lower_offset_mm(*pair.ids.band_b) <=
      0.0) {
    // Real needs an overlap of the meshes.
    if (touch.state == ContactState::kFree) return {1.0, true};
    if (touch.state == ContactState::kUndecided) return {touch.t_clear, true};
    if (touch.state == ContactState::kContact) t_start = touch.t_contact;
  }
  pair.status.held_again = is_held_again(pair);
  if (pair.status.held_again) ++pair.effort.counts.pairs_held_again;
  return pair.status.held_again ? SearchedTime{0.0, true} : SearchedTime{t_start, false};
}

double free_time(PairWork& pair, bool slides, CcdScratch& ccd) {
  SweptQuery query = swept_query(pair);
  query.slides = slides;
  const double t_start = pair.effort.t_stop_start;
  // Faces without width may touch anywhere: the depth never lacks anything, and says no time.
  const bool may_touch = elsewhere_mm(pair) > -kAdvanceAccuracy_mm;
  const Advance advance =
      may_touch ? Advance{Advanced::kUnsure, t_start} : advance_to_real(pair, t_start, ccd);
  if (advance.state == Advanced::kRealAtStart) return withdrawal_time(pair, ccd);
  const double allowed_mm = pair.ids.memo->allowed_depth_mm;
  if (std::isfinite(allowed_mm)) pair.ids.memo.change().allowed_depth_mm = kInfinity;
  if (advance.state == Advanced::kDone) return advance.t_free;

  query.at_target.work_cap = pair.effort.cap_of(kRealTimeWorkCap);
  const InterferenceTime real = find_interference_time(query, ccd);
  ++pair.effort.counts.depth_queries;
  pair.effort.counts.depth_evaluations += real.evaluations;
  pair.answer.place = real.certain_place;
  if (real.real_at_start) return withdrawal_time(pair, ccd);
  const double t_free = std::max(advance.t_free, real.t_free);
  if (real.capped && t_free == 0.0 && std::isfinite(allowed_mm)) {
    pair.ids.memo.change().allowed_depth_mm = allowed_mm;
    return leave_brink(pair, ccd);
  }
  if (real.capped) pair.status.undecided = true;
  return t_free;
}

}  // namespace

bool is_held_again(PairWork& pair) {
  const auto& held = pair.ids.memo->held;
  // Who slides goes another way than what was held.
  if (!held || pair.status.blocked || std::isfinite(pair.ids.memo->allowed_depth_mm) ||
      !identical(held->X_WA, pair.segment.motion_a.X_W0) ||
      !identical(held->X_WB, pair.segment.motion_b.X_W0))
    return false;
  const double speed_mm = relative_travel_upper_bound_mm(
      {pair.ids.solid_a, pair.ids.solid_b, pair.segment.motion_a, pair.segment.motion_b});
  const auto holds_at = [&](double path_mm) {
    const double t = path_mm < speed_mm ? path_mm / speed_mm : 1.0;
    return is_certain_at(overlap_query(pair, t), held->place, pair.effort.counts.depth_evaluations);
  };
  const bool again = std::any_of(std::begin(kHeldPaths_mm), std::end(kHeldPaths_mm), holds_at) ||
                     (held->gave_up && std::any_of(std::begin(kHeldAfterGivingUp_mm),
                                                   std::end(kHeldAfterGivingUp_mm), holds_at));
  if (again) pair.answer.place = held->place;
  return again;
}

double withdrawal_time(PairWork& pair, CcdScratch& ccd) { return withdrawal_until(pair, 1.0, ccd); }

void note_stalled(PairWork& pair) {
  const std::uint8_t in_vain = times_in_vain(pair);
  if (pair.ids.memo->stalled) pair.ids.memo.change().stalled.reset();
  if (!pair.status.undecided || pair.answer.t_stop > 0.0) return;
  PairMemo::Stalled& stalled = pair.ids.memo.change().stalled.emplace(push_of(pair));
  stalled.in_full = !pair.answer.short_of_work;
  stalled.in_vain =
      static_cast<std::uint8_t>(std::min(in_vain + (pair.answer.short_of_work ? 0 : 1), 250));
}

std::uint8_t times_in_vain(const PairWork& pair) {
  const auto& before = pair.ids.memo->stalled;
  return before && identical(before->X_WA, pair.segment.motion_a.X_W0) &&
                 identical(before->X_WB, pair.segment.motion_b.X_W0)
             ? before->in_vain
             : std::uint8_t{0};
}

bool is_stalled(const PairWork& pair) {
  const auto& before = pair.ids.memo->stalled;
  if (!before) return false;
  const PairMemo::Stalled now = push_of(pair);
  const auto dot = [](const PairMemo::Stalled& x, const PairMemo::Stalled& y) {
    return x.shift.dot(y.shift) + x.turn.dot(y.turn);
  };
  return identical(before->X_WA, now.X_WA) && identical(before->X_WB, now.X_WB) &&
         dot(*before, now) >= kSamePushCosine * std::sqrt(dot(*before, *before) * dot(now, now));
}

double free_by_covers(PairWork& pair) {
  if (pair.ids.plain() || pair.ids.no_inside()) return 0.0;
  if (!pair.answer.certain_free)
    pair.answer.certain_free =
        certain_free_until(swept_query(pair), pair.effort.counts.depth_evaluations);
  const double t = pair.answer.certain_free->t;
  // Who has come out is not withdrawn any more.
  if (t > 0.0 && std::isfinite(pair.ids.memo->allowed_depth_mm))
    pair.ids.memo.change().allowed_depth_mm = kInfinity;
  return t;
}

SearchedTime stop_time_without_search(PairWork& pair, const FirstContact& touch) {
  // Without an inside there is no depth and so no real verdict: nobody is stopped.
  if (pair.ids.no_inside())
    return {touch.state == ContactState::kUndecided ? touch.t_clear : 1.0, true};
  SearchedTime time = start_of_search(pair, touch);
  if (!time.known) time.t = std::max(time.t, free_by_covers(pair));
  const bool by_covers = !time.known && time.t >= 1.0;
  time.known |= by_covers;
  pair.effort.t_stop_start = time.t;
  // A word rests on no more than touching.
  pair.status.never_real = time.known && time.t >= 1.0 &&
                           std::isinf(pair.ids.memo->allowed_depth_mm) &&
                           (!by_covers || pair.answer.certain_free->closely);
  return time;
}

double stop_time_with_bands(PairWork& pair, bool slides, CcdScratch& ccd) {
  const double t_free = free_time(pair, slides, ccd);
  // Who withdraws is real all the while.
  pair.status.never_real = t_free >= 1.0 && std::isinf(pair.ids.memo->allowed_depth_mm);
  return t_free;
}

}  // namespace mortise
