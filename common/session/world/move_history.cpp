#include "common/session/world/move_history.h"

#include <algorithm>

#include "common/base/check.h"
#include "common/base/constants.h"

namespace mortise {
namespace {

template <class Entry>
void push_bounded(std::vector<Entry>& entries, Entry entry) {
  if (entries.size() >= kMostUndoMoves) entries.erase(entries.begin());
  entries.push_back(std::move(entry));
}

std::uint64_t last_number(const std::vector<MoveHistory::Done>& done) {
  return done.empty() ? 0 : done.back().number;
}

template <class Undone>
auto last_of(Undone& undone, UserId user) {
  return std::find_if(undone.rbegin(), undone.rend(),
                      [user](const auto& entry) { return entry.move.user == user; });
}

}  // namespace

void MoveHistory::note(UserId user, const Pose& X_WP_before) {
  if (open) return;
  push_bounded(done, {user, X_WP_before, ++moves});
  std::erase_if(undone, [user](const Undone& entry) { return entry.move.user == user; });
  open = true;
}

void MoveHistory::note_edit(UserId user, const Pose& X_WP_before, const PartForm& before) {
  end_move();
  note(user, X_WP_before);
  done.back().form_before = before;
  end_move();
}

std::optional<PartForm> MoveHistory::form_of_undo() const {
  return done.empty() ? std::nullopt : done.back().form_before;
}

std::optional<PartForm> MoveHistory::form_of_redo(UserId user) const {
  const auto entry = last_of(undone, user);
  return entry == undone.rend() ? std::nullopt : entry->form_after;
}

void MoveHistory::forget(UserId user) {
  for (Done& move : done)
    if (move.user == user) move.user = UserId{};
  std::erase_if(undone, [user](const Undone& entry) { return entry.move.user == user; });
}

MoveHistory::Answer MoveHistory::may_undo(UserId user) const {
  if (done.empty()) return {Refusal::kNothingToUndo, UserId{}};
  if (done.back().user != user) return {Refusal::kMovedBySomeoneElse, done.back().user};
  return {};
}

MoveHistory::Answer MoveHistory::may_redo(UserId user) const {
  const auto entry = last_of(undone, user);
  if (entry == undone.rend()) return {Refusal::kNothingToRedo, UserId{}};
  if (entry->below == last_number(done)) return {};
  // Somebody moved the part further, or took back what the undone move began from.
  const bool is_further = last_number(done) > entry->below;
  return {Refusal::kMovedBySomeoneElse, is_further ? done.back().user : undone.back().move.user};
}

Pose MoveHistory::undo(const Pose& X_WP, const PartForm& form) {
  MORTISE_CHECK(!done.empty(), "there is no move to undo: ask may_undo first");
  const Done last = done.back();
  done.pop_back();
  std::optional<PartForm> form_after;
  if (last.form_before) form_after = form;
  push_bounded(undone, {last, X_WP, last_number(done), form_after});
  open = false;  // the next move of the same grab can be undone in its turn
  return last.X_WP_before;
}

Pose MoveHistory::redo(UserId user) {
  const auto entry = last_of(undone, user);
  MORTISE_CHECK(entry != undone.rend(), "there is no move to repeat: ask may_redo first");
  const Undone again = *entry;
  undone.erase(std::next(entry).base());
  push_bounded(done, again.move);
  open = false;
  return again.X_WP_after;
}

}  // namespace mortise
