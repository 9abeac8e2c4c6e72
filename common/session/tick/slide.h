#pragma once
#include "common/session/tick/tick_work.h"

namespace mortise {

// Policy slide. What is left of a body's increments when it meets something for real goes on along
// the tangent cone of all its contacts (tangent_cone.h), as a leg of its own from that time of the
// tick to its end; the leg is judged like any other motion, so that a part never goes where stop
// would not let it. Time runs on as under stop: legs follow each other at the times at which
// something more holds the body back, or lets it go. At most kMostLegs legs a body and tick.

/// With bands a slide sets out, and keeps off what it leans on, by so much, mm: nearer than that
/// its way costs the search as much as a touch. Less than any clearance.
inline constexpr double kBandLift_mm = 1.5e-3;

/// The body that this move belongs to goes on from time t along what holds it. False: there is no
/// way on, or it had its legs.
bool start_leg(const World& world, Scratch::Impl& work, std::int32_t move, double t,
               StepCounters& counters);

/// When what holds the body lets go of it on its present leg, sought at no more than
/// kMostLooks places of the leg before time t_end; 2: it does not.
void look_for_release(const World& world, Scratch::Impl& work, SlidingGroup& sliding, double t_end);

}  // namespace mortise
