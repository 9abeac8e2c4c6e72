#include "common/session/tick/step.h"

#include <algorithm>

#include "common/session/tick/candidate_pairs.h"
#include "common/session/tick/clash_identity.h"
#include "common/session/tick/commit.h"
#include "common/session/tick/contact_budget.h"
#include "common/session/tick/contacts.h"
#include "common/session/tick/depth_budget.h"
#include "common/session/tick/gather.h"
#include "common/session/tick/response.h"
#include "common/session/tick/stage_checks.h"
#include "common/session/tick/statistics.h"
#include "common/session/tick/tick_work.h"
#include "common/session/tick/verdicts.h"
#include "common/session/world/review.h"

namespace mortise {
namespace {

Unexamined why_unexamined(const PairWork& pair) {
  if (pair.effort.contact_waits) return Unexamined::kWaitsForContact;
  // Who is owed a verdict is judged again in the next tick, with more work.
  if (pair.effort.counts.pairs_waiting > 0 ||
      (pair.status.owed && !pair.status.goes_on && !pair.status.lingers))
    return Unexamined::kWaitsForDepth;
  if (pair.status.undecided || pair.status.withdrawal_unsure || pair.effort.counts.not_examined > 0)
    return Unexamined::kGivenUp;
  return pair.status.hidden ? Unexamined::kNoInside : Unexamined::kUnknown;
}

// Counts of the pairs, added in their order, and which have no verdict.
void count_pairs_of(const World& world, const Scratch::Impl& work, StepReport& report) {
  StepCounters& counters = report.counters;
  std::vector<std::uint32_t> open_parts;
  for (std::size_t i = 0; i < work.pair_count; ++i) {
    const PairWork& pair = work.pairs[i];
    accumulate(counters, pair.effort.counts);
    if (!pair.status.asked) {
      ++(pair.status.together ? counters.pairs_still : counters.pairs_budget);
      continue;
    }
    ++counters.pairs.out;
    ++counters.contacts.in;
    if (const Unexamined why = why_unexamined(pair); why != Unexamined::kUnknown)
      report.unexamined.push_back({world.parts[pair.ids.a].id, world.parts[pair.ids.b].id, why});
    if (pair.status.undecided || pair.status.withdrawal_unsure) ++counters.not_examined;
    if (pair.status.undecided) {
      ++counters.contacts_undecided;
    } else if (pair.status.near || pair.status.touching) {
      ++counters.contacts.out;
    } else {
      ++counters.contacts_clear;
    }
    if (pair.status.hidden && !pair.status.undecided && !pair.status.withdrawal_unsure)
      ++counters.not_examined;
    if (!pair.status.near || !pair.judged.judgement.overlap.no_inside) continue;
    for (const std::uint32_t part : {pair.ids.a, pair.ids.b})
      if (!world.parts[part].solid->has_inside()) open_parts.push_back(part);
  }
  std::sort(open_parts.begin(), open_parts.end());
  open_parts.erase(std::unique(open_parts.begin(), open_parts.end()), open_parts.end());
  counters.parts_without_inside += open_parts.size();
}

void note_changed_memos(SessionState& state, Scratch::Impl& work) {
  for (std::size_t i = 0; i < work.pair_count; ++i) {
    PairWork& pair = work.pairs[i];
    if (pair.ids.memo.changed())
      state.touch(SessionState::key_of(pair.ids.a, pair.ids.b), pair.ids.memo.change());
  }
}

}  // namespace

Scratch::Scratch(int threads) : impl_(std::make_unique<Impl>(std::max(1, threads))) {}
Scratch::~Scratch() = default;

StepReport step(World& world, std::span<const Increment> increments, Scratch& scratch) {
  Scratch::Impl& work = scratch.impl();
  SessionState& state = session_state(world, work.switches.brute_force_pairs);
  state.tick = ++world.tick;
  StepReport report;
  report.tick = world.tick;
  tell_reviews(world, state, report);
  end_unjudged_clashes(world, state, report);
  // The stages. Each reads what the ones before have written.
  gather(world, increments, work, report);
  find_candidate_pairs(world, state, work, report);
  open_depth_budget(world, state, work);
  open_contact_budget(world, state, work);
  if (!work.moves.empty()) {
    check_pairs(world, work);
    find_contacts(world, work);
    respond(world, work, report);
    check_contacts(work);
    find_verdicts(world, work);
    check_verdicts(work);
    commit(world, state, work, report);
    check_committed(world, state, report);
    note_held(world, work);
    report_clashes(world, state, work, report);
    count_pairs_of(world, work, report);
    note_changed_memos(state, work);
  }
  close_depth_budget(state, work);
  close_contact_budget(state, work);
  report.state_hash = state_hash(world, state);
  return report;
}

}  // namespace mortise
