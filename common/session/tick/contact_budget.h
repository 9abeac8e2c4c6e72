#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

// What a tick may spend on first contact, counted in tests of boxes and leaves (1 to 2 us each) and
// never in time, so that a replay decides the same. Each pair is asked with a small share, with
// which nearly all come to an end; whose share did not do is asked again with all that a pair may
// have, as long as the tick has work, and what that takes beyond is taken from the next ticks. Held
// parts come first, and who comes last changes from tick to tick. A pair that is not asked, or not
// to the end, is proven clear up to FirstContact::t_clear and no farther: it is left there, and
// counted in not_examined. A part of what ticks do not need is saved for one that needs more.

void open_contact_budget(const World& world, const SessionState& state, Scratch::Impl& work);
void close_contact_budget(const World& world, SessionState& state, const Scratch::Impl& work);

/// Is there no limit? In the first tick of a session, and without budgets.
bool is_contact_unlimited(const Scratch::Impl& work);
/// The pairs in the order in which they are served.
std::vector<std::uint32_t> contact_order(const World& world, const Scratch::Impl& work,
                                         std::span<const std::uint32_t> pairs);

/// So many pairs are asked at once, before what was spent is counted again: of all, and of those
/// whose share did not do or who had none.
inline constexpr std::size_t kContactBatch = 16, kDearBatch = 2;

/// Sets PairWork::contact_cap of these pairs to a share of the tick's own work; 0 where nothing is
/// left of it.
void share_contact_work(const World& world, Scratch::Impl& work,
                        std::span<const std::uint32_t> batch);

/// Sets it to all that a pair may have. False: the tick has no work left.
bool share_more_contact_work(Scratch::Impl& work, std::span<const std::uint32_t> batch);

}  // namespace mortise
