#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "common/session/memory/session_state.h"

namespace mortise {

struct PairWork;

/// What a tick is given work for: first contact, the time at which a pair stops, its verdict.
enum class WorkStage : std::uint8_t { kContact = 0, kStop = 1, kVerdict = 2 };

/// How much of one kind of work ticks may spend. Work is counted and never timed, so that a replay
/// decides the same.
struct WorkRules {
  double per_second = 0.0;        ///< of a session for one thread, see World::threads
  std::int64_t least = 0;         ///< in a tick of it, however high the tick rate is
  std::int64_t saved_ticks = 0;   ///< what ticks may save together, in ticks' own work
  std::int64_t owed_ticks = 0;    ///< more than this is not paid back, in ticks' own work
  double extra_per_second = 0.0;  ///< saved in every tick, whatever it used
};

/// The work of one tick: its own, and what earlier ticks have saved or taken in advance.
class WorkBudget {
 public:
  /// A quarter of what a tick does not need is saved.
  static constexpr std::int64_t kSavedShare = 4;

  /// The first tick of a session has no limit, because nobody waits for it yet. `times`: factor on
  /// the tick's own work.
  void open(const WorkRules& rules, const World& world, std::int64_t saved, bool limited,
            std::int64_t times = 1);
  bool is_limited() const { return limited_; }
  std::uint64_t own() const { return static_cast<std::uint64_t>(own_); }
  /// What was saved before this tick; 0 when work is owed.
  std::uint64_t saved() const { return static_cast<std::uint64_t>(saved_ > 0 ? saved_ : 0); }
  /// What may still be spent when `used` is spent; what is owed is paid from the tick's own work.
  std::uint64_t left(std::uint64_t used) const;
  /// What is saved (or, negative, owed) for the next tick. Debts are paid in full before anything
  /// is saved.
  std::int64_t close(std::uint64_t used) const;

 private:
  std::int64_t own_ = 0, saved_ = 0, saved_most_ = 0, owed_most_ = 0, extra_ = 0;
  bool limited_ = true, first_ = false;
};

/// x - y, or 0.
inline std::uint64_t less(std::uint64_t x, std::uint64_t y) { return x > y ? x - y : 0; }

/// Does a user hold a part that moves in it?
bool is_held(const World& world, const PairWork& pair);

/// So many ticks a pair that nobody holds waits behind one that is held.
inline constexpr std::uint32_t kHeldLead_ticks = 30;
/// Who is first in the order of a stage is served after at most so many ticks.
inline constexpr std::uint32_t kLongestFirst_ticks = 11;
/// Where n pairs ask for the work of a stage, each is served after so many ticks in a row in which
/// it asked for some, however little there is. The README of this room proves it, and for whom.
constexpr std::uint64_t longest_wait_ticks(std::uint64_t n) {
  return kHeldLead_ticks + kLongestFirst_ticks * n;
}

/// The pairs in the order in which they are served: who has waited longest first. A pair whose
/// parts nobody holds comes after one that is held, unless it has waited longer by the lead.
void in_order(const World& world, std::span<const PairWork> work,
              std::span<const std::uint32_t> pairs, WorkStage stage,
              std::vector<std::uint32_t>& order);

/// For how many ticks in a row it was not served.
std::uint32_t waited_of(const PairWork& pair, WorkStage stage);

/// What a pair used of the work that it was given in a stage.
struct UsedWork {
  std::uint64_t used = 0, cap = 0;
  bool capped = false;      ///< it was not enough
  std::uint64_t first = 0;  ///< estimate for a pair of which nothing is known yet
};
/// Sets the estimate for the next tick: one and a half times what was used, or twice the cap when
/// that was not enough. An easy tick lowers the estimate by an eighth only, and the estimate of a
/// pair that was given less than it wanted stays.
void note_effort(PairWork& pair, WorkStage stage, const UsedWork& work);
/// Counts for how many ticks in a row the pair was not served; once in a tick, however often it is
/// asked.
void note_waiting(PairWork& pair, WorkStage stage, bool served);

}  // namespace mortise
