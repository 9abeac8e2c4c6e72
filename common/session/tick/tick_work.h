#pragma once
#include <cstdint>
#include <vector>

#include "common/session/tick/islands.h"
#include "common/session/tick/pair_work.h"
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

/// Switches off optimizations, for tests; apart from counters the report must not change.
struct StepSwitches {
  bool known_distances = true;
  bool brute_force_pairs = false;  ///< at the first step of a world
  bool work_budget = true;         ///< false: every pair has the most that one may have
  bool held_places = true;         ///< false: who is held is found held by a search each tick
  bool told_goes_on = true;        ///< false: what is told is looked at anew each tick
  bool islands = true;             ///< false: all that moves responds as one island
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
  Islands islands;  ///< of the response
};

}  // namespace mortise
