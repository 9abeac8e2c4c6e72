#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

/// What is told of a pair is looked at anew in one of so many ticks; between them it is enough that
/// it is proven to go on.
constexpr std::uint64_t kLookAgain_ticks = 16;

/// Is something told of the pair that may go on without a look in this tick? Not in the tick in
/// which it is looked at anew, nor after a decision about it.
bool may_go_on(const World& world, const PairWork& pair);

// Each is proven by the covers of both parts in some microseconds, which count as evaluations.

/// The class that the pair had when it was last looked at goes on through the whole segment: fake,
/// since the largest parts stay apart while their meshes are as near as before; potential, since
/// the least parts stay apart and a point is in both largest parts at its end.
bool goes_on(PairWork& pair, CcdScratch& ccd);

/// Nothing is even possible in the whole segment.
bool is_never_possible(PairWork& pair);

/// A point is in both largest parts at the end of the segment.
bool is_possible_at_end(PairWork& pair);

/// Told is real; nothing is certain any more, but what holds is potential, and whether real is left
/// by enough is for a look to say.
bool lingers(const World& world, PairWork& pair);

/// The place that holds the pair back is one of a clash that is told as real: real goes on.
bool is_told_there(const World& world, const PairWork& pair);

}  // namespace mortise
