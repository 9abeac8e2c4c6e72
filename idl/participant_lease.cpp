#include "idl/participant_lease.h"

#include <dlfcn.h>

#include <fastdds/rtps/builtin/data/ParticipantProxyData.h>
#include <fastdds/rtps/builtin/discovery/participant/PDP.h>
#include <fastdds/rtps/resources/TimedEvent.h>
#include <fastrtps/config.h>
#include <chrono>
#include <mutex>

static_assert(FASTRTPS_VERSION_MAJOR == 2 && FASTRTPS_VERSION_MINOR == 9,
              "another Fast DDS: see whether its check of leases still asserts; if not, drop this");

namespace eprosima::fastrtps::rtps {

// Called by a timer of each remote participant. Whoever left while the timer waited for the lock
// has no GUID any more, and nothing is to be done.
void PDP::check_remote_participant_liveliness(ParticipantProxyData* remote_participant) {
  std::unique_lock<std::recursive_mutex> lock(*getMutex());
  ParticipantProxyData& remote = *remote_participant;
  if (!remote.should_check_lease_duration || remote.m_guid == GUID_t::unknown()) return;
  const std::chrono::duration<double, std::milli> left = remote.last_received_message_tm() +
                                                         remote.lease_duration() -
                                                         std::chrono::steady_clock::now();
  if (left.count() < 0.0) {
    const GUID_t guid = remote.m_guid;
    lock.unlock();
    remove_remote_participant(guid, ParticipantDiscoveryInfo::DROPPED_PARTICIPANT);
    return;
  }
  remote.lease_duration_event->update_interval_millisec(left.count());
  remote.lease_duration_event->restart_timer();
}

}  // namespace eprosima::fastrtps::rtps

namespace mortise {

bool lease_check_in_force() {
  void* found = dlsym(RTLD_DEFAULT, kLeaseCheckName);
  Dl_info of_found, of_own;
  return found != nullptr && dladdr(found, &of_found) != 0 &&
         dladdr(kLeaseCheckName, &of_own) != 0 && of_found.dli_fbase == of_own.dli_fbase;
}

}  // namespace mortise
