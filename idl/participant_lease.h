#pragma once

namespace mortise {

/// PDP::check_remote_participant_liveliness(ParticipantProxyData*), as the linker names it.
inline constexpr char kLeaseCheckName[] =
    "_ZN8eprosima8fastrtps4rtps3PDP35check_remote_participant_livelinessEPNS1_"
    "20ParticipantProxyDataE";

/// Fast DDS 2.9.1 ends the process (an assertion in PDP::check_remote_participant_liveliness) when
/// a participant leaves at the moment in which its lease is looked at: seen when sixteen left at
/// once. That look is done here instead, by a function of the same name, which the dynamic linker
/// prefers to the library's. True: it does so in this program. False where a program hides its
/// symbols from libraries; there a participant that leaves may still end it.
bool lease_check_in_force();

}  // namespace mortise
