#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/base/rare.h"
#include "common/broadphase/broad_phase.h"
#include "common/ccd/distance.h"
#include "common/ccd/first_contact.h"
#include "common/depth/depth.h"
#include "common/session/world/world.h"

namespace mortise {

/// What is known of a pair of parts, so that it need not be asked again.
struct PairMemo {
  /// Since a part was placed, or a statement about the pair changed, the clashes that were open
  /// then have not been judged at all, or not at the present poses.
  bool not_judged = false, not_seen = false;
  /// The surfaces are at least apart_mm from each other when A stands at X_BA as seen from B
  /// (negative: nothing is known). A statement about poses, which stays true when a part jumps.
  Pose X_BA;
  double apart_mm = -1.0;
  /// Sum of both parts' `placements` when the two entries below were made; another sum voids them.
  std::uint64_t placements = 0;
  /// Neither part contained the other, and the surfaces have not met since.
  bool not_contained = false;
  /// How many more ticks to ask before the distance is measured again, and how long to wait when
  /// that measurement turns out useless as well.
  std::uint8_t pause = 0, next_pause = 1;
  /// The last place where they were nearest: looked at first the next time.
  DistanceResult nearest;
  /// Policy stop, pair real at the start of a tick: least certain overlap seen so far, mm; a motion
  /// may not go deeper. Infinite: not real.
  double allowed_depth_mm = std::numeric_limits<double>::infinity();
  /// Where the pair last held a part back, and the poses at which they have stood since, proven not
  /// to be real.
  struct Held {
    Pose X_WA, X_WB;
    CertainPlace place;
    bool gave_up = false;  ///< the search that left them there did, at its cap
  };
  Rare<Held> held;
  /// A search for the stop that had no result: the poses, and the wanted motion of A against B, its
  /// rotation as the path of the smaller part's rim.
  struct Stalled {
    Pose X_WA, X_WB;
    Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();
    bool in_full = false;  ///< it had all the work that it may have
    bool judged = false;   ///< and what it would have led to was judged
    /// Consecutive searches from there, for any push, that had full work and no result.
    std::uint8_t in_vain = 0;
  };
  Rare<Stalled> stalled;
  /// What a stage of the last ticks needed of work, and for how many ticks it has waited for it;
  /// see work_budget.h. By WorkStage.
  struct Effort {
    std::uint32_t wanted = 0;  ///< tests or evaluations; 0: not yet asked
    std::uint32_t waited = 0;
  };
  std::array<Effort, 3> effort;
  bool touched = false;            ///< listed in SessionState::touched
  std::uint64_t touched_tick = 0;  ///< when it last was
};

/// Read access to the memo of a pair. Changes go through change(), because copies are kept, see
/// SessionState::touched.
class MemoInUse {
 public:
  MemoInUse() = default;
  explicit MemoInUse(PairMemo& memo) : memo_(&memo) {}
  const PairMemo& operator*() const { return *memo_; }
  const PairMemo* operator->() const { return memo_; }
  PairMemo& change() {
    changed_ = true;
    return *memo_;
  }
  bool changed() const { return changed_; }

 private:
  PairMemo* memo_ = nullptr;
  bool changed_ = false;
};

/// One clash between begin and end.
struct OpenClash {
  ClashEvent last;  ///< the last event sent
  Verdict now;      ///< as of the last tick in which the pair was asked
  CollisionClass worst_class = CollisionClass::kNone;
  Interval worst_delta_mm;
  Vec3 p_A = Vec3::Zero(), p_B = Vec3::Zero();  ///< its place, as a point of either part, mm
  /// Class and depth at the last review.
  CollisionClass approved_class = CollisionClass::kNone;
  Interval approved_delta_mm;
  bool revised =
      false;  ///< what was told of it is of another mesh: it is told anew when it is seen
};

/// State of a part beside the record in World.
struct PartState {
  double growth_mm = 0.0;        ///< of its box: largest outward offset it may have, and slack
  std::uint64_t placements = 0;  ///< times it was placed without a motion
  std::uint64_t last_tick = 0;   ///< of its last motion
  UserId last_user;              ///< whose motion that was
  std::uint64_t hash = 0;        ///< of pose and holder
  /// The decision that makes its pairs be judged anew in tick cause_tick.
  Decision::Kind cause = Decision::Kind::kUnknown;
  UserId cause_user;
  std::uint64_t cause_tick = 0;
};

/// The rest of an accepted push whose part waits for work: the part continues it in the next tick,
/// together with new increments. As an increment about the part's reference point, mm and rad,
/// world axes.
struct KeptPush {
  std::uint32_t part = 0;  ///< index
  UserId user;
  Pose X_WP;  ///< where the part was left; the push is dropped when the part was placed elsewhere
  Vec3 shift_mm = Vec3::Zero(), turn_rad = Vec3::Zero();
};

using PartPair = std::pair<PartId, PartId>;

/// Caches and open clashes between ticks. Most of it only saves work; but the place that held a
/// pair, the work that it needed and how long it has waited influence later ticks, so that a
/// session continues identically only with all of it.
struct SessionState {
  std::uint64_t tick = 0;
  std::uint64_t event_seq = 0;
  std::uint32_t next_clash = 1;
  std::uint64_t present_parts = 0, moving_parts = 0;  ///< of the present ones
  std::unique_ptr<BroadPhase> broad_phase;
  std::vector<PartState> parts;
  std::vector<std::uint32_t> placed;  ///< parts placed since the last tick, no repeats
  std::vector<IndexPair> owed;        ///< pairs that the last tick had no work to judge, sorted
  std::vector<KeptPush> kept;         ///< by part
  std::vector<std::uint32_t> rehash;  ///< parts whose pose or holder changed
  /// By part indices; looked up, never iterated. Entries are never removed.
  std::unordered_map<std::uint64_t, PairMemo> memos;
  /// Memos that have changed since somebody last copied them, no repeats; see io/checkpoint.h.
  struct Touched {
    std::uint64_t key = 0;
    PairMemo* memo = nullptr;
  };
  std::vector<Touched> touched;
  std::map<PartPair, std::vector<OpenClash>> open;  ///< clashes of a pair by ClashId
  std::vector<ClashEvent> reviews;                  ///< made since the last tick, told in the next
  bool clashes_changed = true;
  bool edited = false;  ///< the scene, since the last tick: clashes may have nobody who judges them
  std::int64_t saved_work = 0;   ///< evaluations, see depth_budget.h; negative: owed
  std::int64_t saved_tests = 0;  ///< the same of first contact, see contact_budget.h
  std::uint64_t parts_hash = 0;  ///< sum of PartState::hash
  std::uint64_t clashes_hash = 0;

  static std::uint64_t key_of(std::uint32_t a, std::uint32_t b) {
    return (static_cast<std::uint64_t>(a) << 32) | b;
  }
  PairMemo& memo(std::uint32_t a, std::uint32_t b) {
    const auto [found, is_new] = memos.try_emplace(key_of(a, b));
    if (is_new) touch(found->first, found->second);
    return found->second;
  }
  void touch(std::uint64_t key, PairMemo& memo) {
    if (!memo.touched) touched.push_back({key, &memo});
    memo.touched = true;
    memo.touched_tick = tick;
  }
};

/// The state of the world, made when there is none yet: then every moving part counts as just
/// placed, so that the first tick judges how the session begins. `brute_force_pairs` takes the twin
/// of the broad phase.
SessionState& session_state(World& world, bool brute_force_pairs = false);

/// The user id passes to another user: clashes and reviews of the former user stay without a user.
void forget_user(SessionState& state, UserId user);

/// Part `index` was placed at a pose by this decision. No effect before the first step.
void note_placed(World& world, std::uint32_t index, const Decision& by);
/// The holder of part `index` changed.
void note_holder(World& world, std::uint32_t index);
/// The form of part `index` changed, or it is new: lists and boxes follow, and where it is present
/// its pairs are judged again in the next tick.
void note_form(World& world, std::uint32_t index, const Decision& by);
/// The mesh of part `index` is another one: drops what is known of the old one. Before note_form().
void note_mesh(World& world, std::uint32_t index);
/// The statements about the surface of `part` changed, or, with `other`, those of this pair alone:
/// drops what depends on them, and has the pairs judged again in the next tick.
void note_surface(World& world, PartId part, PartId other, const Decision& by);
/// The response policy changed: drops how deep pairs may go.
void note_policy(World& world);

/// Is the pair judged in ticks? Both are there, and one of them moves.
bool is_judged(const World& world, PartId a, PartId b);

/// An empty state for this number of parts, to be filled by a restore; and the boxes of all parts,
/// once growth and poses are set.
std::unique_ptr<SessionState> empty_state(const World& world);
void set_resting_boxes(const World& world, SessionState& state);

/// Numbers of parts, after they changed.
void count_parts(const World& world, SessionState& state);

/// World box of a resting part, grown by what may lie outside of its mesh; empty for one that was
/// removed.
Box resting_box(const World& world, const SessionState& state, std::uint32_t index);

/// Hash over tick, poses, holders, open clashes and their verdicts. Costs only what changed.
std::uint64_t state_hash(const World& world, SessionState& state);

}  // namespace mortise
