#pragma once
#include <cstdint>
#include <fastdds/rtps/common/GuidPrefix_t.hpp>
#include <memory>

#include "idl/peer_removals.h"
#include "idl/peers_heard.h"

// Three functions of Fast DDS 2.9.1 as the linker names them, with what takes their place here.

/// PDP::check_remote_participant_liveliness(ParticipantProxyData*): the look at a lease. The
/// library's ends the process (an assertion) where its participant has just left: seen when sixteen
/// left at once. Here nothing is done then; who has forgotten us is gone as if its lease had ended;
/// and whoever is gone is removed in another thread: see know_peers().
#define MORTISE_LEASE_CHECK                                                 \
  "_ZN8eprosima8fastrtps4rtps3PDP35check_remote_participant_livelinessEPNS" \
  "1_20ParticipantProxyDataE"

/// SecurityManager::encode_rtps_message(const CDRMessage_t&, CDRMessage_t&, const
/// std::vector<GuidPrefix_t>&) const: encryption of a message. The library's ends the process (an
/// assertion) where the only receiver left after the message was written and before another thread
/// sent it: seen when one client left and another came. Here the message is not sent then; else
/// this is the library's.
#define MORTISE_ENCODE                                                  \
  "_ZNK8eprosima8fastrtps4rtps8security15SecurityManager19encode_rtps_" \
  "messageERKNS1_12CDRMessage_tERS4_RKSt6vectorINS1_12GuidPrefix_tESaIS9_EE"

/// AESGCMGMAC_Transform::compute_sessionkey(std::array<uint8_t, 32>&, bool, const
/// std::array<uint8_t, 32>&, const std::array<uint8_t, 32>&, uint32_t, int): the key of a session
/// out of master key, salt and the session's number. The library computes it anew for each datagram
/// that comes in (some 6 us). Here it is kept; the library's computes what is not there yet.
#define MORTISE_SESSION_KEY                                             \
  "_ZN8eprosima8fastrtps4rtps8security20AESGCMGMAC_Transform18compute_" \
  "sessionkeyERSt5arrayIhLm32EEbRKS5_S8_ji"

namespace mortise {

/// The dynamic linker prefers functions of the program to those of a library. True: it finds these
/// first. False where a program hides its symbols from libraries; there a participant that leaves
/// may still end it, and keys cost more. Whether the library asks the linker at all was decided
/// when it was built (Debian's does): see override_uses().
bool overrides_in_force();

/// Whoever the participant `own` has to remove is given to `removals`. Who is silent of `peers`,
/// which may be null, is removed when its lease is next looked at, which is within that. A
/// participant of which this was not said removes in the thread of its timers.
void know_peers(const eprosima::fastrtps::rtps::GuidPrefix_t& own,
                const std::shared_ptr<PeerRemovals>& removals,
                const std::shared_ptr<PeersHeard>& peers);

/// How often the library came by, in this process.
struct OverrideUses {
  std::uint64_t lease_checks = 0, encodings = 0, session_keys = 0;
};
OverrideUses override_uses();

}  // namespace mortise
