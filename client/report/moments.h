#pragma once
#include <functional>
#include <set>
#include <utility>

#include "common/base/result.h"
#include "common/io/log/session_log_read.h"
#include "common/io/scenario/scene_load.h"
#include "common/session/world/world.h"

namespace mortise {

/// One event of a log, with the parts at the poses of its verdict: at the end of the tick, where
/// the increments would have led a part that was stopped, or where it passed through another part.
struct Moment {
  const World& world;
  const ClashEvent& event;
};

/// Which events: tick and clash.
using EventKeys = std::set<std::pair<std::uint64_t, ClashId>>;

/// Visits the wanted events of a log in order without computing it. Poses are those of the log (a
/// float, 4e-6 rad), good enough for pictures, and available in a damaged log. Changed rules are in
/// force from their tick on. Guided parts and groups are shown where they ended. Fails when the
/// scene of the log cannot be loaded. Costs the scene and one pass.
Status for_moments(const SessionLog& log, const EventKeys& wanted,
                   const std::function<void(const Moment&)>& visit);

/// The scene as the log has it after a tick, or at its end, in the same way.
Result<LoadedScene> scene_after(const SessionLog& log, std::uint64_t tick);

}  // namespace mortise
