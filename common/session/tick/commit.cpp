#include "common/session/tick/commit.h"

#include "common/session/guide/guidance.h"
#include "common/session/memory/kept_push.h"

namespace mortise {

void commit(World& world, SessionState& state, Scratch::Impl& work, StepReport& report) {
  for (const Move& move : work.moves) {
    Part& part = world.parts[move.part];
    PartState& part_state = state.parts[move.part];
    if (move.motion.moves()) {  // even when held at once: it was this user who pushed
      part_state.last_tick = world.tick;
      part_state.last_user = move.user;
    }
    if (!identical(part.X_WP, move.X_WP_end)) {
      part.history.note(move.user, part.X_WP);
      part.X_WP = move.X_WP_end;
      report.moved.push_back({part.id, part.holder, part.X_WP});
      state.rehash.push_back(move.part);
    }
    state.broad_phase->set_box(move.part, resting_box(world, state, move.part));
  }
  state.placed.clear();
  state.kept = kept_pushes(world, work, report.counters);
  // What the tick had no work for is looked at as it stands, should it not move on.
  state.owed.clear();
  for (std::size_t i = 0; i < work.pair_count; ++i)
    if (work.pairs[i].status.owed) state.owed.push_back({work.pairs[i].ids.a, work.pairs[i].ids.b});
  if (world.guides.empty()) return;
  std::vector<PartId> moved, held_back;
  for (const Move& move : work.moves)
    if (move.motion.moves())
      (move.stopped || move.sliding >= 0 ? held_back : moved).push_back(world.parts[move.part].id);
  settle_guides(world, moved, held_back);
}

}  // namespace mortise
