#include "server/scheduling.h"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstring>
#include <string>

namespace mortise {
namespace {

// Behind every other thread, and yet not at a standstill on a busy machine.
constexpr int kNice = 10;

}  // namespace

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

void run_behind_others() {
  run_as_others();
  (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), kNice);
}

}  // namespace mortise
