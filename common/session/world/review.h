#pragma once
#include "common/messages/report.h"
#include "common/session/memory/session_state.h"

namespace mortise {

/// The open clash of this id; null when there is none.
OpenClash* find_open(World& world, ClashId clash);
const OpenClash* find_open(const World& world, ClashId clash);

/// Sets the review status of an open clash; published in the next tick. No effect when the clash is
/// not open.
void review(World& world, const Decision& decision);

/// A clash that begins where both parts have been since the start is approved where the scenario
/// says so of the pair.
void approve_where_it_starts(const World& world, const SessionState& state, OpenClash& clash);

/// Publishes the reviews made since the last tick, before all other events of the tick.
void tell_reviews(const World& world, SessionState& state, StepReport& report);

/// Is an approved clash worse than what was approved: of a worse class, or certainly deeper than it
/// can have been then?
bool is_worse_than_approved(const OpenClash& clash, double hysteresis_mm);

/// Makes an approved clash active again and gives the reason in the comment.
void take_back_approval(OpenClash& clash, std::uint64_t tick);

}  // namespace mortise
