#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/depth/depth.h"
#include "common/session/memory/session_state.h"
#include "common/session/tick/judgement.h"

namespace mortise {

/// Who is asked about, and what is known of them at the start of the tick; a < b.
struct PairIds {
  std::uint32_t a = 0, b = 0;
  std::int32_t move_a = -1, move_b = -1;  ///< index of the part's Move; -1: still
  const Solid *solid_a = nullptr, *solid_b = nullptr;
  const PairRule* rule = nullptr;
  const SurfaceBand *band_a = nullptr, *band_b = nullptr;
  double band_mm = 0.0;  ///< distance at which the pair has to be looked at
  MemoInUse memo;
  std::vector<OpenClash>* open = nullptr;  ///< null: none
  bool placed = false;                     ///< neither moves, one was put somewhere

  /// The meshes are the parts: no deviation or tolerance is known.
  bool plain() const { return band_a->trivial && band_b->trivial; }
  /// A part without an inside is potential at best, so that it stops no part.
  bool no_inside() const { return !solid_a->has_inside() || !solid_b->has_inside(); }
};

/// The piece [tau, 1] of the tick in which a pair is asked about; its motions run from 0 to 1.
struct Segment {
  double tau = 0.0;
  Motion motion_a, motion_b;
};

/// What first contact and the search for the time of *real* say of a segment. Times are of the
/// segment, but for t_stop.
struct SegmentAnswer {
  bool entered = false;  ///< came within the band during the segment
  bool meets = false;    ///< the meshes touch or overlap at some time, first at t_contact
  bool overlaps_at_start = false;
  bool touch_unasked = false;  ///< meets, t_contact, overlaps_at_start are not known
  double t_contact = 1.0;
  double t_enter = 0.0;  ///< nothing to judge before: plain pairs do not overlap, others stay clear
  double t_stop = 1.0;   ///< of the tick: the pair is proven not to become real before
  bool stop_gave_up = false;   ///< the search for t_stop used up its work
  bool short_of_work = false;  ///< and had been given less than a pair may have
  CertainPlace place;          ///< a place that makes the pair real, where one is known
  /// Of the segment: the covers prove until then that nothing is certain; nullopt: not asked.
  std::optional<FreeUntil> certain_free;
};

/// The answer over an earlier piece of the tick, judged in place of the last piece.
struct AskedEarlier {
  Segment segment;
  SegmentAnswer answer;
  double t_end = 1.0;  ///< of the tick: until then
};

/// How a pair stands in the tick.
struct PairStatus {
  bool asked = false;       ///< false: an earlier or a new distance proves that they stay apart
  bool near = false;        ///< overlapping or within the band at some time: to be judged
  bool touching = false;    ///< touched at the start and got no deeper: nothing to judge
  bool hidden = false;      ///< clear, but one may lie where the inside of the other is not known
  bool undecided = false;   ///< a work cap was reached
  bool never_real = false;  ///< proven by the search for t_stop, over the whole segment
  double apart_at_end_mm = 0.0;    ///< lower bound, when neither near nor touching
  bool blocks = false;             ///< the response stopped a part because of this pair
  bool held_again = false;         ///< at once, by the place that has held it back before
  bool goes_on = false;            ///< what is told of it, proven without a look
  bool lingers = false;            ///< what is told is perhaps left: to be seen when its parts rest
  bool together = false;           ///< both move as one: their clashes stay as they are
  bool owed = false;               ///< near, but not judged to the end: again in the next tick
  bool withdrawal_unsure = false;  ///< the search along a withdrawal used up its work
  double t_left = 2.0;  ///< of the tick: the parts went other ways from then on; 2: they did not
  std::optional<AskedEarlier> blocked, passed;  ///< policy slide: first time that it held a part
                                                ///< back; near, and left again
};

/// What a pair may spend in the tick, and what it has spent.
struct PairEffort {
  std::array<bool, 3> aged{};  ///< by WorkStage: that it waits is counted for this tick

  // On first contact, in tests; see contact_budget.h.
  std::uint64_t contact_cap = kCcdWorkCap;  ///< of one question
  std::uint64_t contact_tests = 0;          ///< used in the tick
  std::uint64_t contact_start = 0;          ///< and before the present question
  bool contact_short = false;               ///< a question came to the end of that
  bool contact_waits = false;               ///< none was asked, for want of work
  /// How far the questions that came to the end of their work got: at the distance of the band, and
  /// at which the meshes touch. Times of the segment.
  double clear_of_band = 0.0, clear_of_touch = 0.0;

  // On depth, in evaluations; see depth_budget.h.
  std::uint64_t cap = ~std::uint64_t{0}, stage_start = 0;
  std::uint64_t most_work = 0;   ///< that a pair may have in the stage
  bool limited = false;          ///< by the budget of the tick
  bool wants_stop_time = false;  ///< t_stop is only what is known without a search
  double t_stop_start = 0.0;     ///< of the segment: where that search begins
  bool stalled = false;          ///< it got no work, because the same push had no result before

  StepCounters counts;  ///< of this pair alone, merged in pair order

  /// Was it given less than most_work?
  bool may_have_more() const { return cap < most_work; }
  /// What is left of its work in the stage.
  std::uint64_t left() const {
    const std::uint64_t used = counts.depth_evaluations - stage_start;
    return used < cap ? cap - used : 0;
  }
  /// The cap of one question: never 0, so that the answer is at least a bracket. A hundred
  /// evaluations look at the deepest pair of triangles and those beside it.
  std::uint64_t cap_of(std::uint64_t most) const {
    constexpr std::uint64_t kGlance = 100;  // see above
    return std::min(most, std::max(left(), kGlance));
  }
};

/// One region of a pair as judged in this tick, and the open clash that it continues.
struct SeenRegion {
  Verdict verdict;
  Vec3 p_A = Vec3::Zero(), p_B = Vec3::Zero();  ///< its place, as a point of either part
  int open = -1;          ///< index among the open clashes of the pair; -1: a new clash
  bool tell = false;      ///< begin or change is due
  bool passing = false;   ///< begins and ends within the tick
  int of_judgement = -1;  ///< which verdict of the pair's judgement it is; -1: of none
};

/// The verdicts of a near pair, and what is told of them.
struct JudgedPair {
  Judgement judgement;
  JudgementQuery query;  ///< of that judgement
  bool tells = false;    ///< an event of it is due
  std::vector<SeenRegion> seen;
  bool unsettled = false;  ///< another class than told, but within the hysteresis
  bool in_full = false;    ///< then its depth is refined completely
  double t_potential = kNever, t_real = kNever;  ///< of the tick; for pairs with an event
  std::vector<char> keeps;  ///< by open clash: not seen, but not gone either (hysteresis)
};

/// One candidate pair on its way through the tick. Each stage writes what is its own: candidates
/// the ids, contacts and response the segment, its answer and the status, verdicts what is judged.
struct PairWork {
  PairIds ids;
  Segment segment;
  SegmentAnswer answer;
  PairStatus status;
  PairEffort effort;
  JudgedPair judged;
};

}  // namespace mortise
