#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

// What a tick may spend on first contact, counted in tests of boxes and leaves (1 to 2 us each).
// Pairs are served in the order of in_order(). Each is asked with what it needed the last time, or
// with a first share; then those whose share did not do go on from where they are proven clear, two
// at a time, with all that a pair may have, as long as the tick has work left. Whose turn it is may
// take more than is left: the next ticks pay for it. A pair that is not asked, or not to the end,
// is proven clear up to FirstContact::t_clear and no farther: it is left there, and counted in
// not_examined.

/// The most of one question, some 50 ms and more: where that does not do, the pair is left where it
/// is clear.
inline constexpr std::uint64_t kMostContactTests = 50'000;

void open_contact_budget(const World& world, const SessionState& state, Scratch::Impl& work);
void close_contact_budget(SessionState& state, const Scratch::Impl& work);

/// Sets PairWork::contact_cap of the first of these pairs and returns how many are asked next, at
/// once: as many as the tick has work for, at least two. 0: the tick has no work left.
std::size_t share_contact_work(Scratch::Impl& work, std::span<const std::uint32_t> order);

/// Remembers what the pair used of it. True: that was not enough, and it may have more.
bool note_contact_effort(PairWork& pair);
/// Counts whether it was asked in this tick, with all that it wanted.
void note_contact_waiting(PairWork& pair);

}  // namespace mortise
