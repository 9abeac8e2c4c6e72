#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "common/io/log/session_log.h"

/// The records /checkpoints and /totals of a session log, see session_log_format.md. Decoders take
/// any bytes, and give false when they are no such record, or damaged.
namespace mortise::log_records {

/// `state.hash` is worked out here.
std::vector<std::byte> encode(const Checkpoint& state);
/// The bytes are held against the hash, and kept when `keep` says so.
bool decode(std::span<const std::byte> bytes, Checkpoint& out, bool keep);

std::vector<std::byte> encode(const SessionStatistics& totals);
bool decode(std::span<const std::byte> bytes, SessionStatistics& out);

}  // namespace mortise::log_records
