#pragma once
#include <functional>
#include <string>

#include "common/io/log/session_log_read.h"
#include "common/io/report_json.h"

namespace mortise {

/// The whole chain that led to one verdict, computed again: increments, motion, first contact,
/// region, concave-convex, deviation and tolerance of both faces, thresholds, verdict; and what was
/// told of the clash over its life. mm, rad, s; world frame unless a key ends in _part.
/// `tick` 0: the worst moment of the clash. An error when the log tells of no such clash, or cannot
/// be computed up to it. Cost: the session up to that tick.
/// `on_tick` is told each tick that was computed; may be empty.
Result<Json> explain_clash(SessionLog log, ClashId clash, std::uint64_t tick = 0,
                           const std::function<void(std::uint64_t)>& on_tick = {});

}  // namespace mortise
