#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

// Policy slide. The rest of a body's increments after a real contact runs along the tangent cone of
// all its contacts (tangent_cone.h), as a leg from that time to the end of the tick. The leg is
// judged like any other motion, so that a part never goes where `stop` would not allow it. A new
// leg begins when a further contact holds the body back, or a contact releases it. At most
// kMostLegs legs for a body and tick.

/// With bands a slide starts, and stays, this far from what it leans on, mm. Nearer than that its
/// path costs the search as much as a touch. Less than any clearance.
inline constexpr double kBandLift_mm = 1.5e-3;

/// Makes the body of this move one that slides, before its first leg. The other functions may run
/// for several islands at once, this one may not.
void prepare_leg(const World& world, Scratch::Impl& work, std::int32_t move);

/// Starts a leg of the body of this move of the island, at time t along what holds it. False: no
/// motion is left, or the body has used up its legs.
bool start_leg(const World& world, Scratch::Impl& work, Island& island, std::int32_t move, double t,
               CcdScratch& ccd);

/// Searches at most kMostLooks places of the present leg before t_end for the time at which a
/// contact releases the body; 2: it does not.
void look_for_release(const World& world, Scratch::Impl& work, const Island& island,
                      SlidingGroup& sliding, double t_end, CcdScratch& ccd);

}  // namespace mortise
