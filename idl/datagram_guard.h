#pragma once
#include <cstddef>
#include <span>

namespace mortise {

/// How many leading bytes of an RTPS datagram may be handed to Fast DDS; 0: drop it all. Refuses
/// impossible lengths, unknown submessages, sequence ranges that eat memory, unterminated parameter
/// lists, type objects, and lengths of what is encrypted that are not those of the datagram; cuts
/// at a statistics submessage. Each rule stands for a crash or a resource attack of Fast DDS 2.9.1
/// (see README). O(datagram).
std::size_t admissible_length(std::span<const std::byte> datagram);

}  // namespace mortise
