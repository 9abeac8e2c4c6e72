#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/messages/channel.h"

namespace mortise {

/// Whose hand a user is, as the inbox knows it; what one that takes over has to know of it.
struct SeatRecord {
  UserId user;
  ClientKey client;
  std::uint64_t nonce = 0;
};

/// A piece of a mesh that a decision will name; they come in order.
struct MeshPiece {
  std::string hash;  ///< of the mesh
  double quantum_mm = 0.0;
  std::uint64_t length = 0, offset = 0;  ///< bytes, see mesh_bytes.h
  std::vector<std::byte> bytes;
};

/// What went into a tick and what came of it, for a server that follows.
struct FollowedTick {
  std::uint64_t tick = 0, state_hash = 0;
  std::int64_t time_ns = 0;
  std::vector<Decision> decisions;
  std::vector<Increment> increments;
  bool has_seats = false;
  std::vector<SeatRecord> seats;  ///< of all users present; only with has_seats
  bool hands_over = false;        ///< the last of the one that leads: go on from here
  /// All ticks up to here are in the log of the one that leads, as far as they ever will be.
  std::uint64_t logged_tick = 0;
  std::optional<MeshPiece> mesh = {};
};

std::vector<std::byte> encode(const FollowedTick& tick);
/// Takes any bytes; false when they are none.
bool decode(std::span<const std::byte> bytes, FollowedTick& tick);

}  // namespace mortise
