#pragma once
#include <functional>
#include <set>
#include <utility>

#include "common/base/result.h"
#include "common/io/log/session_log.h"
#include "common/session/world/world.h"

namespace mortise {

/// One event of a log, with the parts where its verdict was judged: at the end of the tick, where
/// the increments would have led a part that was stopped, or where it passed through another.
struct Moment {
  const World& world;
  const ClashEvent& event;
};

/// Which events: tick and clash.
using EventKeys = std::set<std::pair<std::uint64_t, ClashId>>;

/// Goes through a log without computing it, and shows the wanted events in order. Poses are those
/// of the log (a float, 4e-6 rad): good for pictures, and for what is left of a damaged log. Rules
/// that people changed are in force from their tick on. Parts that were guided or in a group are
/// shown where they ended. Fails when the scene of the log cannot be loaded. Cost: the scene, and
/// one pass.
Status for_moments(const SessionLog& log, const EventKeys& wanted,
                   const std::function<void(const Moment&)>& visit);

}  // namespace mortise
