#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// What a fuzzer feeds: each takes any bytes, and ends the process (MORTISE_CHECK) when something
/// that must hold for all inputs does not.
namespace mortise::test {

/// A datagram for the guard; and, behind a first byte that picks the type, a serialized sample for
/// the door, as SafeType and from_wire() meet it. Says whether it came through the door.
bool fuzz_wire(std::span<const std::uint8_t> input);

/// A script of what clients send, for the inbox. Says whether an increment was taken.
bool fuzz_inbox(std::span<const std::uint8_t> input);

/// A session log, as its reader meets it. Seeds have no checksums: they would keep most mutations
/// out. Says whether it was read.
bool fuzz_log(std::span<const std::uint8_t> input);

/// A scenario file: read, linted, its scene made, its log begun, judged. Meshes are not read from
/// files. Says whether it was usable.
bool fuzz_scenario(std::span<const std::uint8_t> input);

/// Good inputs, made by our own writers: the start of all mutations.
std::vector<std::string> wire_seeds();
std::vector<std::string> inbox_seeds();

}  // namespace mortise::test
