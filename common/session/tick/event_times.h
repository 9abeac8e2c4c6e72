#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

/// Fills in pair.judged.t_potential and pair.judged.t_real by a search; only for pairs with an
/// event. Reads pair.judged.seen and the segments over which the pair was asked. t_end: time of the
/// tick at which the movers of the pair were stopped, 1 when they were not.
void find_event_times(PairWork& pair, double t_end, CcdScratch& ccd);

}  // namespace mortise
