#include "idl/fast_dds_repairs.h"

#include <dlfcn.h>

#include <fastdds/rtps/builtin/data/ParticipantProxyData.h>
#include <fastdds/rtps/builtin/discovery/participant/PDP.h>
#include <fastdds/rtps/common/CDRMessage_t.h>
#include <fastdds/rtps/resources/TimedEvent.h>
#include <fastrtps/config.h>
#include <chrono>
#include <fastdds/rtps/common/GuidPrefix_t.hpp>
#include <mutex>
#include <vector>

static_assert(FASTRTPS_VERSION_MAJOR == 2 && FASTRTPS_VERSION_MINOR == 9,
              "another Fast DDS: see whether its functions below still assert; if not, drop this");

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

using eprosima::fastrtps::rtps::CDRMessage_t;
using eprosima::fastrtps::rtps::GuidPrefix_t;
using Receivers = std::vector<GuidPrefix_t>;

// No installed header declares the class of which this is a member: its name is all that there is.
bool encode_for_somebody(const void* manager, const CDRMessage_t& plain, CDRMessage_t& encoded,
                         const Receivers& receivers) __asm__(MORTISE_ENCODE_NAME);

// Called where a message is about to be sent. False: it is not sent, which is right where nobody is
// left to receive it.
bool encode_for_somebody(const void* manager, const CDRMessage_t& plain, CDRMessage_t& encoded,
                         const Receivers& receivers) {
  if (receivers.empty()) return false;
  static const auto library_s =
      reinterpret_cast<decltype(&encode_for_somebody)>(dlsym(RTLD_NEXT, kEncodeName));
  return library_s != nullptr && library_s(manager, plain, encoded, receivers);
}

namespace {

bool is_own(const char* name) {
  void* found = dlsym(RTLD_DEFAULT, name);
  Dl_info of_found, of_own;
  return found != nullptr && dladdr(found, &of_found) != 0 && dladdr(kEncodeName, &of_own) != 0 &&
         of_found.dli_fbase == of_own.dli_fbase;
}

}  // namespace

bool repairs_in_force() { return is_own(kLeaseCheckName) && is_own(kEncodeName); }

}  // namespace mortise
