#include "common/session/tick/event_times.h"

#include <algorithm>

#include "common/session/tick/pair_queries.h"

namespace mortise {
namespace {

// Evaluations of each of the two searches, some 10 ms of work. At the cap a time of that kind is
// told that is not proven to be the first.
constexpr std::uint64_t kEventTimeWorkCap = 3'000;
// The same within a tick that has others to serve: its events are told to a share of the tick.
constexpr std::uint64_t kEventTimeWorkCapOfTick = 750;

// Halvings: to 1.2e-4 of what was open. Evaluations of each look; chosen.
constexpr int kHalvings = 13;
constexpr std::uint64_t kLookWorkCap = 1'000;

CollisionClass worst_told(const PairWork& pair) {
  CollisionClass worst = CollisionClass::kNone;
  for (const SeenRegion& seen : pair.judged.seen)
    if (seen.tell) worst = std::max(worst, seen.verdict.collision_class);
  return worst;
}

// At the cap: what has the class at the end of the motion has it since that time at the latest. Of
// anything else it is not known whether it was so on the way.
void count(PairWork& pair, std::uint64_t evaluations, bool capped, bool is_told) {
  ++pair.effort.counts.event_time_queries;
  pair.effort.counts.depth_evaluations += evaluations;
  if (capped && is_told) ++pair.effort.counts.event_times_at_latest;
  if (capped && !is_told) pair.status.undecided = true;
}

// Where the search leaves more of the tick open between what is clear and what is not, the time at
// which they do interfere is told.
constexpr double kClose = 1e-3;

enum class Asked { kPossible, kReal };

bool interferes_at(PairWork& pair, const SweptQuery& swept, double t, Asked asked,
                   CcdScratch& ccd) {
  OverlapQuery query = swept.at_target;
  query.X_WA = swept.motion_a.pose_at(t);
  query.X_WB = swept.motion_b.pose_at(t);
  query.work_cap = pair.effort.cap_of(kLookWorkCap);
  query.want_delta = false;
  const OverlapResult overlap = find_overlap(query, ccd);
  pair.effort.counts.depth_evaluations += overlap.evaluations;
  return std::any_of(overlap.regions.begin(), overlap.regions.end(), [&](const auto& region) {
    return asked == Asked::kPossible ? region.possible_mm.lo > 0.0 : region.certain_mm.lo > 0.0;
  });
}

// A time at which they interfere, after `clear` and not after `known`; kNever when not even at
// `known`.
double halved(PairWork& pair, const SweptQuery& swept, double clear, double known, Asked asked,
              CcdScratch& ccd) {
  if (!interferes_at(pair, swept, known, asked, ccd)) return kNever;
  for (int i = 0; i < kHalvings && pair.effort.left() > 0; ++i) {
    const double middle = 0.5 * (clear + known);
    (interferes_at(pair, swept, middle, asked, ccd) ? known : clear) = middle;
  }
  return known;
}

// With bands the two times differ, and neither is that of the meshes.
void search(PairWork& pair, CollisionClass worst, CcdScratch& ccd) {
  const auto in_tick = [&](double t) { return pair.segment.tau + (1.0 - pair.segment.tau) * t; };
  SweptQuery query = swept_query(pair);
  query.at_target.work_cap =
      pair.effort.cap_of(pair.effort.limited ? kEventTimeWorkCapOfTick : kEventTimeWorkCap);
  const PossibleTime possible = find_possible_time(query, ccd);
  count(pair, possible.evaluations, possible.capped, worst >= CollisionClass::kPotential);
  const bool close = possible.t_possible - possible.t_clear <= kClose;
  if (possible.becomes_possible)
    pair.judged.t_potential = in_tick(close ? possible.t_clear : possible.t_possible);
  // The cap may come before the proof, yet after a time.
  if (possible.capped && !possible.becomes_possible)
    pair.judged.t_potential =
        in_tick(halved(pair, query, possible.t_clear, possible.t_possible, Asked::kPossible, ccd));
  if (!possible.becomes_possible && !possible.capped) return;
  if (pair.status.blocks) {
    // The response knows it already.
    pair.judged.t_real = pair.answer.t_stop;
  } else if (!pair.ids.no_inside() && !pair.status.never_real) {
    const InterferenceTime real = find_interference_time(query, ccd);
    count(pair, real.evaluations, real.capped, worst >= CollisionClass::kReal);
    if (real.becomes_real) pair.judged.t_real = in_tick(real.t_real);
    if (real.capped && !real.becomes_real)
      pair.judged.t_real =
          in_tick(halved(pair, query, real.t_free, real.t_real, Asked::kReal, ccd));
  }
}

}  // namespace

void find_event_times(PairWork& pair, double t_end, CcdScratch& ccd) {
  pair.judged.t_potential = pair.judged.t_real = kNever;
  const CollisionClass worst = worst_told(pair);
  if (pair.ids.placed) {
    t_end = 0.0;
  } else if (!pair.ids.plain()) {
    search(pair, worst, ccd);
  } else if (pair.answer.meets) {
    // The meshes are the parts: they interfere from where they press in, but for the rounding of
    // their files.
    pair.judged.t_potential = pair.segment.tau + (1.0 - pair.segment.tau) * pair.answer.t_enter;
    if (!pair.ids.no_inside() && (pair.ids.band_mm == 0.0 || worst >= CollisionClass::kReal))
      pair.judged.t_real = pair.judged.t_potential;
  }
  if (pair.status.blocks) t_end = 1.0;
  if (pair.judged.t_potential > t_end) pair.judged.t_potential = kNever;
  if (pair.judged.t_real > t_end) pair.judged.t_real = kNever;
  // What the verdict says at the end of the motion holds there at the latest.
  if (worst >= CollisionClass::kReal) pair.judged.t_real = std::min(pair.judged.t_real, t_end);
  if (worst >= CollisionClass::kPotential)
    pair.judged.t_potential = std::min(pair.judged.t_potential, t_end);
  pair.judged.t_potential = std::min(pair.judged.t_potential, pair.judged.t_real);
}

}  // namespace mortise
