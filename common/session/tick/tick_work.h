#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/depth/interference_time.h"
#include "common/session/memory/session_state.h"
#include "common/session/tick/judgement.h"
#include "common/session/tick/step.h"
#include "common/session/tick/tangent_cone.h"
#include "common/session/tick/work_budget.h"
#include "common/session/tick/worker_pool.h"
#include "common/session/world/moving_group.h"

namespace mortise {

/// One part that the tick moves, or that was placed since the last tick (then still).
struct Move {
  std::uint32_t part = 0;  ///< index
  UserId user;
  Motion motion;            ///< as asked for
  double turned_rad = 0.0;  ///< sum of the rotations of its increments
  bool placed = false;      ///< was placed: nothing is known of its pairs
  bool owed = false;        ///< a pair of it waits for a verdict
  double stop = 1.0;        ///< time at which the response ends it
  bool stopped = false;
  Pose X_WP_end;  ///< after the response
  GroupId group;  ///< moves as one with the other parts of it
  /// The present piece of its path: `motion`, or, when it slides, the leg from time leg_start of
  /// the tick to its end.
  Motion leg;
  double leg_start = 0.0;
  Box reach;                  ///< the part stays in this box; pairs are chosen by it
  std::int32_t sliding = -1;  ///< index among the sliding groups; -1: it does not slide
};

/// A group on its way along what it met (policy slide).
struct SlidingGroup {
  MovingGroup group;                ///< at the start of the tick
  std::vector<std::int32_t> moves;  ///< of its parts
  std::vector<Relation> relations;  ///< that guide it, at the start of the tick
  std::vector<Hold> holds;          ///< of pairs with bands, as they are at the start of the leg
  Twist wanted, given;              ///< of the present leg, whole; about its centre
  double lift_mm = 0.0;             ///< by which a turning leg gets away from what holds it
  int legs = 0, stalls = 0;
  double look = 2.0;  ///< time at which a contact releases it; 2: none does
  bool look_due = false;
};

/// The state of a pair over an earlier piece of the tick, judged in place of the last piece.
struct AskedEarlier {
  double tau = 0.0, t_contact = 1.0, t_enter = 0.0, t_stop = 1.0;
  Motion motion_a, motion_b;
  bool entered = false, meets = false, overlaps_at_start = false, short_of_work = false;
  bool stop_gave_up = false, touch_unasked = false;
  CertainPlace place;
  std::optional<FreeUntil> certain_free;
  double t_end = 1.0;  ///< of the tick: until then
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

/// One candidate pair on its way through the tick; a < b.
struct PairWork {
  std::uint32_t a = 0, b = 0;
  std::int32_t move_a = -1, move_b = -1;  ///< index of the part's Move; -1: still
  const Solid *solid_a = nullptr, *solid_b = nullptr;
  const PairRule* rule = nullptr;
  const SurfaceBand *band_a = nullptr, *band_b = nullptr;
  double band_mm = 0.0;  ///< distance at which the pair has to be looked at
  MemoInUse memo;
  std::vector<OpenClash>* open = nullptr;  ///< null: none
  bool placed = false;                     ///< neither moves, one was put somewhere

  // Stage 3, over the segment [tau, 1] of the tick in which motion_a and motion_b run from 0 to 1;
  // times are of the segment, but for t_stop.
  double tau = 0.0;
  Motion motion_a, motion_b;
  bool asked = false;      ///< false: an earlier or a new distance proves that they stay apart
  bool near = false;       ///< overlapping or within the band at some time: to be judged
  bool touching = false;   ///< touched at the start and got no deeper: nothing to judge
  bool hidden = false;     ///< clear, but one may lie where the inside of the other is not known
  bool entered = false;    ///< came within the band during the segment
  bool undecided = false;  ///< a work cap was reached
  bool meets = false;      ///< the meshes touch or overlap at some time, first at t_contact
  bool overlaps_at_start = false;
  double t_contact = 1.0;
  double t_enter = 0.0;  ///< nothing to judge before: plain pairs do not overlap, others stay clear
  double t_stop = 1.0;   ///< of the tick: the pair is proven not to become real before
  bool never_real = false;       ///< proven by the search for t_stop, over the whole segment
  double apart_at_end_mm = 0.0;  ///< lower bound, when neither near nor touching
  bool blocks = false;           ///< the response stopped a part because of this pair
  bool held_again = false;       ///< at once, by the place that has held it back before
  CertainPlace place;            ///< a place that makes the pair real, where one is known
  /// Of the segment: the covers prove until then that nothing is certain; nullopt: not asked.
  std::optional<FreeUntil> certain_free;

  bool goes_on = false;        ///< what is told of it, proven without a look
  bool lingers = false;        ///< what is told is perhaps left: to be seen when its parts rest
  bool touch_unasked = false;  ///< meets, t_contact, overlaps_at_start are not known
  bool together = false;       ///< both move as one: their clashes stay as they are
  double t_left = 2.0;  ///< of the tick: the parts went other ways from then on; 2: they did not
  std::optional<AskedEarlier> blocked, passed;  ///< policy slide: first time that it held a part
                                                ///< back; near, and left again

  std::array<bool, 3> aged{};  ///< by WorkStage: that it waits is counted for this tick

  // Work on first contact, in tests; see contact_budget.h.
  std::uint64_t contact_cap = kCcdWorkCap;  ///< of one question
  std::uint64_t contact_tests = 0;          ///< used in the tick
  std::uint64_t contact_start = 0;          ///< and before the present question
  bool contact_short = false;               ///< a question came to the end of that
  bool contact_waits = false;               ///< none was asked, for want of work
  /// How far the questions that came to the end of their work got: at the distance of the band, and
  /// at which the meshes touch. Times of the segment.
  double clear_of_band = 0.0, clear_of_touch = 0.0;

  // Work on depth, in evaluations; see depth_budget.h.
  std::uint64_t cap = ~std::uint64_t{0}, stage_start = 0;
  std::uint64_t most_work = 0;     ///< that a pair may have in the stage
  bool limited = false;            ///< by the budget of the tick
  bool wants_stop_time = false;    ///< t_stop is only what is known without a search
  double t_stop_start = 0.0;       ///< of the segment: where that search begins
  bool stop_gave_up = false;       ///< that search used up its work
  bool short_of_work = false;      ///< and had been given less than a pair may have
  bool stalled = false;            ///< or none, because the same push had no result before
  bool withdrawal_unsure = false;  ///< the search along a withdrawal used up its work
  bool owed = false;               ///< near, but not judged to the end: again in the next tick

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
    constexpr std::uint64_t kGlance = 100;
    return std::min(most, std::max(left(), kGlance));
  }

  // Stage 4.
  Judgement judgement;
  JudgementQuery judged;  ///< of that judgement
  bool tells = false;     ///< an event of it is due
  std::vector<SeenRegion> seen;
  bool unsettled = false;  ///< a better class than told, but within the hysteresis
  bool in_full = false;    ///< then its depth is refined completely
  double t_potential = kNever, t_real = kNever;  ///< of the tick; for pairs with an event
  std::vector<char> keeps;  ///< by open clash: not seen, but not gone either (hysteresis)

  StepCounters counts;  ///< of this pair alone, merged in pair order

  /// The meshes are the parts: no deviation or tolerance is known.
  bool plain() const { return band_a->trivial && band_b->trivial; }
  /// A part without an inside is potential at best, so that it stops no part.
  bool no_inside() const { return !solid_a->has_inside() || !solid_b->has_inside(); }
};

/// Switches off optimizations, for tests; apart from counters the report must not change.
struct StepSwitches {
  bool known_distances = true;
  bool brute_force_pairs = false;  ///< at the first step of a world
  bool work_budget = true;         ///< false: every pair has the most that one may have
  bool held_places = true;         ///< false: who is held is found held by a search each tick
  bool told_goes_on = true;        ///< false: what is told is looked at anew each tick
};

struct Scratch::Impl {
  explicit Impl(int threads) : pool(threads), ccd(static_cast<std::size_t>(pool.threads())) {}
  WorkerPool pool;
  std::vector<CcdScratch> ccd;  ///< one a thread
  StepSwitches switches;

  std::vector<Move> moves;                 ///< by part
  std::vector<std::int32_t> move_of_part;  ///< -1: still
  std::vector<std::uint32_t> moved_parts;  ///< part index of moves[i]
  std::vector<IndexPair> candidates;
  std::vector<PairWork> pairs;  ///< sorted; pair_count of them are in use
  std::size_t pair_count = 0;
  WorkBudget contact_budget;           ///< tests of first contact
  WorkBudget depth_budget;             ///< evaluations of depth
  std::vector<std::uint32_t> asked;    ///< pairs that want work of the stage
  std::vector<std::uint32_t> unasked;  ///< pairs of stage 4 that want none
  std::vector<std::uint32_t> to_ask;   ///< pairs to ask about contact: all, or those of a round
  /// In the order in which a stage serves them; whose share of first contact did not do.
  std::vector<std::uint32_t> order, dear, still_dear;
  std::vector<SlidingGroup> sliding;
};

}  // namespace mortise
