#pragma once
#include <functional>

#include "common/session/tick/tick_work.h"

namespace mortise {

// What a tick may spend on first contact, counted in tests of boxes and leaves (some 0.35 us each).
// Pairs are served in the order of in_order(). Each is asked with what it needed the last time, or
// with a first share. Pairs whose share was not enough then continue from where they are proven
// clear, two at a time, with all that a pair may have, as long as the tick has work left. The first
// of them may take more than is left, and the next ticks pay for it. While they pay, nobody is
// asked but one pair: who is first and has waited 11, 22, 33 ... ticks. A pair that is not asked to
// the end is proven clear up to FirstContact::t_clear only, one that is not asked at all goes as
// far as covers prove that nothing is certain. Either is counted in not_examined.

/// The most work of one question, some 50 ms and more. Where that is not enough, the pair is left
/// where it is proven clear.
inline constexpr std::uint64_t kMostContactTests = 50'000;

void open_contact_budget(const World& world, const SessionState& state, Scratch::Impl& work);
void close_contact_budget(SessionState& state, const Scratch::Impl& work);

using AskPair = std::function<void(PairWork&, CcdScratch&)>;

/// Asks these pairs on all threads, those that have waited longest first, with
/// PairWork::contact_cap set; 0 where the tick has no work for the pair.
void ask_in_turn(const World& world, Scratch::Impl& work, std::span<const std::uint32_t> pairs,
                 const AskPair& ask);

/// Sets PairWork::contact_cap of those of these pairs whose meshes are asked for their contact only
/// now, for what is seen or told of them: equal parts of what the tick has left, no less than a
/// first share.
void share_touch_work(Scratch::Impl& work, std::span<const std::uint32_t> pairs);

}  // namespace mortise
