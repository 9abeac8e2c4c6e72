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
#include "common/depth/overlap.h"
#include "common/session/world/world.h"

namespace mortise {

/// What a pair of parts is known to be, so that it need not be asked again.
struct PairMemo {
  /// Since a part of it was put somewhere, or what is stated of them changed, the clashes that were
  /// open then have not been judged at all, or not as the parts stand.
  bool not_judged = false, not_seen = false;
  /// The surfaces are at least apart_mm from each other when A stands at X_BA as seen from B
  /// (negative: nothing is known). A statement about poses, true for ever: no teleport can spoil
  /// it.
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
  /// Where a search for the stop has come to nothing: the poses, and the motion that was asked for,
  /// of A against B, its rotation as way of the smaller part's rim.
  struct Stalled {
    Pose X_WA, X_WB;
    Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();
    bool in_full = false;  ///< it had all the work that it may have
    bool judged = false;   ///< and what it would have led to was judged
    /// Searches in a row, whatever the push, that had all their work and came to nothing there.
    std::uint8_t in_vain = 0;
  };
  Rare<Stalled> stalled;
  /// What a stage of the last ticks needed of work, and for how many ticks it has waited for it;
  /// see work_budget.h. By WorkStage.
  struct Effort {
    std::uint32_t wanted = 0;  ///< tests or evaluations; 0: not yet asked
    std::uint8_t waited = 0;
  };
  std::array<Effort, 3> effort;
  bool touched = false;            ///< listed in SessionState::touched
  std::uint64_t touched_tick = 0;  ///< when it last was
};

/// What is remembered of a pair, for everybody to read. Who changes it says so: copies of it are
/// kept, see SessionState::touched.
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
  /// As it was when people last said something of it.
  CollisionClass approved_class = CollisionClass::kNone;
  Interval approved_delta_mm;
};

/// What the session knows of a part beside the world's own record.
struct PartState {
  double growth_mm = 0.0;        ///< of its box: largest outward offset it may have, and slack
  std::uint64_t placements = 0;  ///< times it was put somewhere without a motion
  std::uint64_t last_tick = 0;   ///< of its last motion
  UserId last_user;              ///< whose motion that was
  std::uint64_t hash = 0;        ///< of pose and holder
  /// The decision that makes its pairs be judged anew in tick cause_tick.
  Decision::Kind cause = Decision::Kind::kUnknown;
  UserId cause_user;
  std::uint64_t cause_tick = 0;
};

/// What is left of a push whose part waits for work: it was accepted, so the part goes on with it
/// in the next tick, together with what is pushed then. As an increment about the part's reference
/// point, mm and rad, world axes.
struct KeptPush {
  std::uint32_t part = 0;  ///< index
  UserId user;
  Pose X_WP;  ///< where the part was left; put elsewhere, it is pushed no more
  Vec3 shift_mm = Vec3::Zero(), turn_rad = Vec3::Zero();
};

using PartPair = std::pair<PartId, PartId>;

/// Caches and open clashes between ticks. Most of it only saves the asking; but what a pair was
/// held by, what it needed of work and how long it has waited decide what later ticks find out, so
/// that a session goes on the same only with all of it.
struct SessionState {
  std::uint64_t tick = 0;
  std::uint64_t event_seq = 0;
  std::uint32_t next_clash = 1;
  std::uint64_t moving_parts = 0;
  std::unique_ptr<BroadPhase> broad_phase;
  std::vector<PartState> parts;
  std::vector<std::uint32_t> placed;  ///< parts put somewhere since the last tick, no repeats
  std::vector<IndexPair> owed;        ///< pairs that the last tick had no work to judge, sorted
  std::vector<KeptPush> kept;         ///< by part
  std::vector<std::uint32_t> rehash;  ///< parts whose pose or holder changed
  /// By part indices; looked up, never walked. None is ever taken out.
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

/// Nobody is this user any more: what they caused and said of clashes stays, and is nobody's.
void forget_user(SessionState& state, UserId user);

/// Part `index` was put at a pose without a motion by this decision. No-op before the first step.
void note_placed(World& world, std::uint32_t index, const Decision& by);
/// The holder of part `index` changed.
void note_holder(World& world, std::uint32_t index);
/// What is stated of the surface of `part` changed, or, with `other`, of this pair alone: what
/// leans on it is forgotten, and the pairs are judged anew in the next tick.
void note_surface(World& world, PartId part, PartId other, const Decision& by);
/// The response policy changed: how deep a pair may go is found out anew.
void note_policy(World& world);

/// A state that holds nothing yet but the parts' number, to be filled from elsewhere; and the boxes
/// of all parts, once growth and poses stand.
std::unique_ptr<SessionState> empty_state(const World& world);
void set_resting_boxes(const World& world, SessionState& state);

/// World box of a resting part, grown by what may lie outside of its mesh.
Box resting_box(const World& world, const SessionState& state, std::uint32_t index);

/// Hash over tick, poses, holders, open clashes and their verdicts. Costs only what changed.
std::uint64_t state_hash(const World& world, SessionState& state);

}  // namespace mortise
