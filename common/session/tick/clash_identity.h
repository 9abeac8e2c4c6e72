#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

/// The open clash that each region of pair.judged.seen continues, whether its event is due, and
/// which open clashes stay although nothing was seen of them. Reads pair.judged.judgement;
/// distance_mm: of the meshes at the end, infinite when not asked.
void match_clashes(const World& world, PairWork& pair, double distance_mm);

/// Is the place one of the clash: on the face of its part that the clash names, or near it?
bool is_at(const OpenClash& clash, const CertainPlace& place, const PairWork& pair);

/// Stage 6. Begin, change and end of clashes.
void report_clashes(const World& world, SessionState& state, Scratch::Impl& work,
                    StepReport& report);

/// Ends the clashes that nobody judges any more after an edit: of parts that are gone, and of two
/// that stand for good.
void end_unjudged_clashes(const World& world, SessionState& state, StepReport& report);

}  // namespace mortise
