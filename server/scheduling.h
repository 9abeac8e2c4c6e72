#pragma once
#include "common/base/result.h"

namespace mortise {

/// Gives the calling thread, and those that it starts from now on, a priority above every ordinary
/// thread: SCHED_RR, the lowest real-time priority. A tick then begins when it is due, whatever
/// else the machine does; the kernel reserves a share for the others (5 % of each second by
/// default). Fails without an effect where it is not permitted (RLIMIT_RTPRIO).
Status run_before_others();

/// Gives the calling thread ordinary priority again, because threads inherit the priority.
void run_as_others();

}  // namespace mortise
