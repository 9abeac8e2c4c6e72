#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/messages/channel.h"

namespace mortise {

/// Whose hand a user is, as the inbox knows it; what one that takes over has to know of it.
struct SeatRecord {
  UserId user;
  ClientKey client;
  std::uint64_t nonce = 0;
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
};

std::vector<std::byte> encode(const FollowedTick& tick);
/// Takes any bytes; false when they are none.
bool decode(std::span<const std::byte> bytes, FollowedTick& tick);

}  // namespace mortise
