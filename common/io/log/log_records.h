#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/geometry/mesh.h"
#include "common/messages/increment.h"
#include "common/messages/report.h"

/// The binary records of a session log, byte by byte as in session_log_format.md. Every decoder
/// accepts any bytes: it returns false when they are no such record, and allocates at most a small
/// multiple of their length.
namespace mortise::log_records {

/// What every record begins with.
struct Decisions {
  std::uint64_t tick = 0;
  std::vector<Decision> decisions;
};
struct Increments {
  std::uint64_t tick = 0;
  std::vector<Increment> increments;
};
/// Positions to a float, rotations to 2e-6 rad: for viewers. Exact poses come from a replay.
struct Poses {
  std::uint64_t tick = 0;
  std::vector<PartPose> poses;
};
/// The last record of a tick; a tick without it is incomplete.
struct TickEnd {
  std::uint64_t tick = 0;
  std::uint64_t state_hash = 0;
  std::vector<RefusedIncrement> refused;
};

std::vector<std::byte> encode(std::uint64_t tick, std::span<const Decision> decisions);
std::vector<std::byte> encode(std::uint64_t tick, std::span<const Increment> increments);
std::vector<std::byte> encode(std::uint64_t tick, std::span<const PartPose> poses);
std::vector<std::byte> encode_end(const StepReport& report, std::uint64_t tick);
std::vector<std::byte> encode(const TriangleMesh& mesh);

bool decode(std::span<const std::byte> bytes, Decisions& out);
bool decode(std::span<const std::byte> bytes, Increments& out);
bool decode(std::span<const std::byte> bytes, Poses& out);
bool decode(std::span<const std::byte> bytes, TickEnd& out);
/// Also checks that every triangle names points of the mesh and that all of them are finite.
bool decode(std::span<const std::byte> bytes, TriangleMesh& out);

}  // namespace mortise::log_records
