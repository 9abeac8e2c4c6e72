#pragma once
#include <cstdint>
#include <vector>

#include "common/math/pose.h"
#include "common/messages/command.h"

namespace mortise {

/// What users did to one part, so that each can take back and repeat their own moves. A move is all
/// that one user does to the part between a grab and the next grab, release, undo, redo or reset.
struct MoveHistory {
  struct Done {
    UserId user;
    Pose X_WP_before;
    std::uint64_t number = 0;  ///< of the move, 1, 2, 3 ...
  };
  struct Undone {
    Done move;
    Pose X_WP_after;
    std::uint64_t below = 0;  ///< number of the move that was the last one after the undo; 0: none
  };
  std::vector<Done> done;      ///< oldest first, at most kMostUndoMoves
  std::vector<Undone> undone;  ///< last undone last, at most kMostUndoMoves
  std::uint64_t moves = 0;
  bool open = false;  ///< the last move goes on

  /// The part is about to leave X_WP_before by this user's doing; no news while their move is open.
  /// What this user has undone before can no longer be repeated.
  void note(UserId user, const Pose& X_WP_before);
  void end_move() { open = false; }
  /// Nobody is this user any more: their moves stay, and are nobody's to take back or repeat.
  void forget(UserId user);

  /// kNone, kNothingToUndo, or kMovedBySomeoneElse: then `by` has moved the part last.
  struct Answer {
    Refusal refusal = Refusal::kNone;
    UserId by;
  };
  Answer may_undo(UserId user) const;
  /// kNone, kNothingToRedo, or kMovedBySomeoneElse: then `by` has moved the part since the undo.
  Answer may_redo(UserId user) const;

  /// Where the part goes, from X_WP. Only when there is a move to undo.
  Pose undo(const Pose& X_WP);
  /// Where the part goes: the move of this user that was undone last. Only when there is one.
  Pose redo(UserId user);
};

}  // namespace mortise
