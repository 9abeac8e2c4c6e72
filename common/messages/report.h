#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "common/base/ids.h"
#include "common/math/pose.h"
#include "common/messages/command.h"
#include "common/messages/event.h"

namespace mortise {

/// One stage of the tick: in = out + sum of skipped. Always counted.
struct StageCount {
  std::uint64_t in = 0, out = 0;
};

/// What the tick did, did not do, and why.
struct StepCounters {
  StageCount increments;                               ///< given to the tick -> applied
  std::array<std::uint64_t, kRefusalCount> refused{};  ///< by Refusal
  StageCount moves;  ///< parts with increments -> parts that really move
  std::uint64_t moves_below_rounding = 0;
  StageCount pairs;  ///< candidate pairs -> pairs asked for first contact or depth
  std::uint64_t pairs_static = 0, pairs_still = 0, pairs_excluded = 0, pairs_boxes_apart = 0,
                pairs_budget = 0;
  StageCount contacts;  ///< pairs asked -> pairs in contact or in the band
  std::uint64_t contacts_clear = 0, contacts_undecided = 0;
  std::uint64_t first_contact_queries = 0, distance_queries = 0, depth_queries = 0;
  std::uint64_t event_time_queries = 0;  ///< searches for when an event became possible or real
  /// Those that a work cap ended: the time is that of the event at the latest.
  std::uint64_t event_times_at_latest = 0;
  /// Pairs judged (depth_queries that asked for verdicts): with bands, or as plain meshes because
  /// nothing is declared of either part. Plain pairs ask for no deviation and no tolerance.
  std::uint64_t judged_with_bands = 0, judged_plain = 0;
  /// Regions whose class was decided while their depth was still a wide bracket, and those that
  /// were refined to the accuracy of depth.
  std::uint64_t regions_decided_early = 0, regions_refined = 0;
  StageCount verdicts;  ///< regions judged -> regions with a class
  std::uint64_t verdicts_by_class[4] = {0, 0, 0, 0};
  std::uint64_t stopped_parts = 0, rounds = 0;
  /// Policy slide: parts that slid along a contact, pieces of their paths (legs), places that held
  /// them, and bodies that stayed where they were because they had too many legs.
  std::uint64_t slid_parts = 0, slide_legs = 0, slide_holds = 0, slides_cut_short = 0;
  std::uint64_t box_tests = 0, triangle_tests = 0, depth_evaluations = 0;
  std::uint64_t parts_without_inside =
      0;  ///< open or non-manifold parts that took part: crossing is found, depth is not
  /// Pairs that wait for a search or a verdict because the tick's work budget was used up.
  std::uint64_t pairs_waiting = 0;
  /// Pairs that hold a part at the place that held it before, without a search or a new verdict.
  std::uint64_t pairs_held_again = 0;
  /// Parts that wait for work and were pushed farther than is kept for them.
  std::uint64_t pushes_cut = 0;
  std::uint64_t not_examined =
      0;  ///< pairs given up by a work cap or overload; never reported as clear
};

struct PartPose {
  PartId part;
  UserId holder;
  Pose X_WP;
};

struct RefusedIncrement {
  UserId user;
  PartId part;
  std::uint64_t seq = 0;
  Refusal reason = Refusal::kNone;
};

/// Why a pair has no verdict of this tick. Goes over the wire, so numbers never change.
enum class Unexamined : std::uint8_t {
  kUnknown = 0,
  kWaitsForContact = 1,  ///< for work on first contact
  kWaitsForDepth = 2,    ///< for work on depth
  kGivenUp = 3,          ///< a search came to the most work that a pair may have
  kNoInside = 4,         ///< the inside of a part is not known where the other one is
};
inline constexpr std::uint8_t kUnexaminedCount = 5;

/// A pair that is counted in StepCounters::not_examined.
struct UnexaminedPair {
  PartId a, b;
  Unexamined why = Unexamined::kUnknown;
};

struct StepReport {
  std::uint64_t tick = 0;
  std::vector<PartPose> moved;     ///< parts whose pose changed, by id
  std::vector<ClashEvent> events;  ///< in order of ClashEvent::seq
  std::vector<RefusedIncrement> refused;
  std::vector<UnexaminedPair> unexamined;  ///< by pair
  StepCounters counters;
  std::uint64_t state_hash =
      0;  ///< of all poses, holders, open clashes and verdicts after the tick
};

}  // namespace mortise
