#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "common/io/log/session_log.h"

/// The records /checkpoints and /totals of a session log, see session_log_format.md. Decoders
/// accept any bytes and return false when they are no such record, or damaged.
namespace mortise::log_records {

/// `state.hash` is computed here.
std::vector<std::byte> encode(const Checkpoint& state);
/// The bytes are compared with the hash, and kept when `keep` is true.
bool decode(std::span<const std::byte> bytes, Checkpoint& out, bool keep);

std::vector<std::byte> encode(const SessionStatistics& totals);
bool decode(std::span<const std::byte> bytes, SessionStatistics& out);

}  // namespace mortise::log_records
