#pragma once

namespace mortise {

/// PDP::check_remote_participant_liveliness(ParticipantProxyData*), as the linker names it.
inline constexpr char kLeaseCheckName[] =
    "_ZN8eprosima8fastrtps4rtps3PDP35check_remote_participant_livelinessEPNS1_"
    "20ParticipantProxyDataE";

/// SecurityManager::encode_rtps_message(const CDRMessage_t&, CDRMessage_t&, const
/// std::vector<GuidPrefix_t>&) const, as the linker names it.
#define MORTISE_ENCODE_NAME                                                             \
  "_ZNK8eprosima8fastrtps4rtps8security15SecurityManager19encode_rtps_messageERKNS1_12" \
  "CDRMessage_tERS4_RKSt6vectorINS1_12GuidPrefix_tESaIS9_EE"
inline constexpr char kEncodeName[] = MORTISE_ENCODE_NAME;

/// Two functions of Fast DDS 2.9.1 end the process by an assertion when a participant leaves at the
/// wrong moment. They are replaced here by functions of the same names, which the dynamic linker
/// prefers to the library's:
/// - the look at a lease, where its participant has just left (seen when sixteen left at once);
/// - with keys, the encryption of a message whose only receiver left after it was written and
///   before another thread sent it (seen when one client left and another came).
/// True: it does so in this program. False where a program hides its symbols from libraries; there
/// a participant that leaves may still end it.
bool repairs_in_force();

}  // namespace mortise
