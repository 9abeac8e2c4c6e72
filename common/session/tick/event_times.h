#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

/// Fills in pair.t_potential and pair.t_real. For pairs of which somebody is told, since it is
/// searched for; reads pair.seen, and what the pair was asked over. t_end: time of the tick at
/// which the movers of the pair were stopped, 1 when they were not.
void find_event_times(PairWork& pair, double t_end, CcdScratch& ccd);

}  // namespace mortise
