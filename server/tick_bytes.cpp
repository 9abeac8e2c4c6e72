#include "server/tick_bytes.h"

#include "common/io/log/log_records.h"
#include "common/io/state/bytes.h"

namespace mortise {
namespace {

void put(ByteWriter& out, const std::vector<std::byte>& bytes) {
  out.varint(bytes.size());
  out.raw(bytes);
}

// User and nonce of a byte each, a text of none behind its length of four bytes.
constexpr std::uint64_t kLeastSeat_bytes = 6;

}  // namespace

std::vector<std::byte> encode(const FollowedTick& tick) {
  ByteWriter out;
  out.varint(tick.tick);
  out.u64(tick.state_hash);
  out.u64(static_cast<std::uint64_t>(tick.time_ns));
  put(out, log_records::encode(tick.tick, std::span<const Decision>(tick.decisions)));
  put(out, log_records::encode(tick.tick, std::span<const Increment>(tick.increments)));
  out.u8(tick.hands_over);
  out.varint(tick.logged_tick);
  out.u8(tick.mesh.has_value());
  if (tick.mesh) {
    out.string(tick.mesh->hash);
    out.f64(tick.mesh->quantum_mm);
    out.varint(tick.mesh->length);
    out.varint(tick.mesh->offset);
    put(out, tick.mesh->bytes);
  }
  out.u8(tick.has_seats);
  if (!tick.has_seats) return out.take();
  out.varint(tick.seats.size());
  for (const SeatRecord& seat : tick.seats) {
    out.varint(seat.user.value);
    out.string(seat.client);
    out.varint(seat.nonce);
  }
  return out.take();
}

bool decode(std::span<const std::byte> bytes, FollowedTick& tick) {
  ByteReader in(bytes);
  tick = {};
  tick.tick = in.varint();
  tick.state_hash = in.u64();
  tick.time_ns = static_cast<std::int64_t>(in.u64());
  log_records::Decisions decisions;
  log_records::Increments increments;
  const auto decision_bytes = in.raw(in.varint());
  const auto increment_bytes = in.raw(in.varint());
  if (!in.ok() || !log_records::decode(decision_bytes, decisions) ||
      !log_records::decode(increment_bytes, increments)) {
    return false;
  }
  tick.decisions = std::move(decisions.decisions);
  tick.increments = std::move(increments.increments);
  tick.hands_over = in.u8() != 0;
  tick.logged_tick = in.varint();
  if (in.u8() != 0) {
    MeshPiece& mesh = tick.mesh.emplace();
    mesh.hash = in.string();
    mesh.quantum_mm = in.f64();
    mesh.length = in.varint();
    mesh.offset = in.varint();
    const auto piece = in.raw(in.varint());
    mesh.bytes.assign(piece.begin(), piece.end());
  }
  tick.has_seats = in.u8() != 0;
  if (tick.has_seats) {
    const std::uint64_t count = in.varint();
    if (!in.room_for(count, kLeastSeat_bytes)) return false;
    for (std::uint64_t i = 0; i < count; ++i) {
      SeatRecord seat;
      seat.user = UserId{in.varint32()};
      seat.client = in.string();
      seat.nonce = in.varint();
      tick.seats.push_back(std::move(seat));
    }
  }
  return in.at_end();
}

}  // namespace mortise
