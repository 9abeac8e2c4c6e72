#pragma once
#include "common/base/result.h"

namespace mortise {

/// Lets the calling thread, and those that it starts from now on, run before every thread of
/// ordinary priority: SCHED_RR, the least of the real-time priorities. A tick then begins when it
/// is due, whatever else the machine does; the kernel leaves the others their share (5 % of each
/// second by default). Fails where it is not permitted (RLIMIT_RTPRIO); the thread is then as it
/// was.
Status run_before_others();

/// The calling thread as any other again: what such a thread starts inherits its priority.
void run_as_others();

}  // namespace mortise
