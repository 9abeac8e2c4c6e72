#include "server/scheduling.h"

#include <pthread.h>
#include <sched.h>

#include <cstring>
#include <string>

namespace mortise {

Status run_before_others() {
  sched_param priority{};
  priority.sched_priority = sched_get_priority_min(SCHED_RR);
  const int error = pthread_setschedparam(pthread_self(), SCHED_RR, &priority);
  if (error != 0) {
    return fail(Code::kRuntime, std::string("ticks run at ordinary priority; SCHED_RR: ") +
                                    std::strerror(error) +
                                    "; `ulimit -r 1` or LimitRTPRIO=1 would permit it");
  }
  return ok();
}

void run_as_others() {
  const sched_param ordinary{};
  (void)pthread_setschedparam(pthread_self(), SCHED_OTHER, &ordinary);
}

}  // namespace mortise
