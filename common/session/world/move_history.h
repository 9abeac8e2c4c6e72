#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/math/pose.h"
#include "common/messages/command.h"

namespace mortise {

/// What a part is, as far as scene edits change it.
struct PartForm {
  bool present = true, moving = false;
  std::string mesh = {};                ///< hash
  std::vector<std::string> notes = {};  ///< what was found in the mesh
  friend bool operator==(const PartForm&, const PartForm&) = default;
};

/// The moves of one part, so that each user can undo and redo their own. A move is everything that
/// one user does to the part between a grab and the next grab, release, undo, redo or reset; or one
/// edit of the scene.
struct MoveHistory {
  struct Done {
    UserId user;
    Pose X_WP_before;
    std::uint64_t number = 0;                  ///< of the move, 1, 2, 3 ...
    std::optional<PartForm> form_before = {};  ///< of an edit
  };
  struct Undone {
    Done move;
    Pose X_WP_after;
    std::uint64_t below = 0;  ///< number of the move that was the last one after the undo; 0: none
    std::optional<PartForm> form_after = {};  ///< of an edit
  };
  std::vector<Done> done;      ///< oldest first, at most kMostUndoMoves
  std::vector<Undone> undone;  ///< last undone last, at most kMostUndoMoves
  std::uint64_t moves = 0;
  bool open = false;  ///< the last move has not ended

  /// Call before this user moves the part away from X_WP_before. Has no effect while the user's
  /// move is open; else it begins a move, and what the user has undone can no longer be redone.
  void note(UserId user, const Pose& X_WP_before);
  void end_move() { open = false; }
  /// Call before this user edits the part.
  void note_edit(UserId user, const Pose& X_WP_before, const PartForm& before);
  /// The user id passes to another user: the former user's moves stay and can no longer be undone
  /// or redone.
  void forget(UserId user);

  /// kNone, kNothingToUndo, or kMovedBySomeoneElse: then `by` has moved the part last.
  struct Answer {
    Refusal refusal = Refusal::kNone;
    UserId by;
  };
  Answer may_undo(UserId user) const;
  /// kNone, kNothingToRedo, or kMovedBySomeoneElse: then `by` has moved the part since the undo.
  Answer may_redo(UserId user) const;

  /// The form that an undo, or a redo of this user, gives back; none: it is no edit.
  std::optional<PartForm> form_of_undo() const;
  std::optional<PartForm> form_of_redo(UserId user) const;

  /// The pose to which the part goes from X_WP. Requires a move to undo.
  Pose undo(const Pose& X_WP, const PartForm& form = {});
  /// The pose to which the part goes: redoes the move of this user that was undone last. Requires
  /// one.
  Pose redo(UserId user);
};

}  // namespace mortise
