#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/session/memory/session_state.h"
#include "common/session/world/world.h"

namespace mortise {

/// All that a session is between two ticks, as bytes: poses, holders, users, rules, constraints,
/// what can be undone, open clashes with their reviews, and everything that the engine remembers of
/// pairs of parts. The scene (meshes, features, scenario) is not in it. The same state gives the
/// same bytes. The world has been stepped at least once. Costs 0.1 us a number.
std::vector<std::byte> encode_state(const World& world);

/// Puts such a state into a world that stands as its scene was loaded and was never stepped; then
/// it goes on as the one from which the bytes came, bit for bit. Takes any bytes: fails, and leaves
/// the world of no use, when they are no state of this scene.
Status restore_state(World& world, std::span<const std::byte> bytes);

/// Number of the layout of these bytes: a checkpoint of another number is not read.
inline constexpr std::uint8_t kStateLayout = 1;

/// A state to be had as bytes later, on another thread, and once.
using StateDraft = std::function<std::vector<std::byte>()>;

/// Makes checkpoints beside a running session without holding up its ticks: what is remembered of
/// pairs is copied in slices, a few pairs in each tick, those first that the tick has left alone,
/// until few are left or the time is over; the rest in one go. Sorting, bytes and compression are
/// left to who finishes the draft. One maker a world.
class CheckpointMaker {
 public:
  CheckpointMaker();
  ~CheckpointMaker();
  /// Before the first tick that it is to see.
  void begin(World& world);
  /// After each tick; `due` begins a checkpoint. Gives one within kMostSlices ticks: of the state
  /// as it stands after this tick. Drafts are finished in their order, or not at all.
  StateDraft after_tick(World& world, bool due);
  /// Begun and not given yet: what is due meanwhile is this one.
  bool running() const { return running_; }

 private:
  struct Copies;
  void copy_settled(SessionState& state);  ///< a slice of what this tick has not changed
  void copy(std::span<const SessionState::Touched> some);

  std::shared_ptr<Copies> copies_;
  bool running_ = false;
  int slices_left_ = 0;
  std::vector<SessionState::Touched> settled_;  ///< of this tick
  std::size_t slice_ = 0;                       ///< memos that one tick copies
  std::size_t at_ = 0;                          ///< where to look next in SessionState::touched
};

}  // namespace mortise
