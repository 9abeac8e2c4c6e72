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

/// The complete state of a session between two ticks, as bytes: poses, holders, users, rules,
/// constraints, undo history, open clashes with their reviews, and everything that the engine
/// remembers of pairs of parts. The scene (meshes, features, scenario) is not included. The same
/// state gives the same bytes. The world must have been stepped at least once.
std::vector<std::byte> encode_state(const World& world);

/// Restores such a state into a world that was loaded and never stepped. It then continues bit for
/// bit like the world from which the bytes came. Accepts any bytes: when they are no state of this
/// scene it fails, and the world must not be used any more.
Status restore_state(World& world, std::span<const std::byte> bytes);

/// Version of the layout of these bytes; a checkpoint of another version is not read.
inline constexpr std::uint8_t kStateLayout = 3;

/// A state that another thread can serialize later, once.
using StateDraft = std::function<std::vector<std::byte>()>;

/// Makes checkpoints beside a running session without delaying its ticks. The memory of pairs is
/// copied in slices, a few pairs in each tick, unchanged pairs first, until few are left or the
/// time is over; then the rest at once. Sorting, serializing and compressing are done by whoever
/// calls the draft. One maker for each world.
class CheckpointMaker {
 public:
  CheckpointMaker();
  ~CheckpointMaker();
  /// Call before the first tick that it is to see.
  void begin(World& world);
  /// Call after each tick; `due` begins a checkpoint. Returns one within kMostSlices ticks, of the
  /// state after that tick. Drafts must be called in their order, or not at all.
  StateDraft after_tick(World& world, bool due);
  /// Is a checkpoint begun and not yet returned? Then `due` has no effect.
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
