#include "common/io/log_records.h"

#include <array>
#include <bit>
#include <cmath>

#include "common/io/bytes.h"

namespace mortise::log_records {
namespace {

// The largest component of a unit quaternion follows from the others, which are at most 1/sqrt(2)
// in size: two bits say which, twenty bits hold each of the others.
constexpr int kQuatBits = 20;
constexpr double kQuatRange = 0.70710678118654752;
constexpr double kQuatSteps = (1 << kQuatBits) - 1;
constexpr std::uint64_t kQuatMask = (1ULL << kQuatBits) - 1;

std::uint64_t pack(const Quat& q) {
  std::array<double, 4> c = {q.x(), q.y(), q.z(), q.w()};
  std::size_t largest = 0;
  for (std::size_t i = 1; i < 4; ++i)
    if (std::abs(c[i]) > std::abs(c[largest])) largest = i;
  const double sign = c[largest] < 0 ? -1.0 : 1.0;
  std::uint64_t packed = largest;
  for (std::size_t i = 0; i < 4; ++i) {
    if (i == largest) continue;
    const double unit = (sign * c[i] / kQuatRange + 1.0) / 2.0;
    const double step = std::round(std::fmin(std::fmax(unit, 0.0), 1.0) * kQuatSteps);
    packed = packed << kQuatBits | static_cast<std::uint64_t>(step);
  }
  return packed;
}

Quat unpack(std::uint64_t packed) {
  const std::size_t largest = packed >> (3 * kQuatBits) & 3;
  std::array<double, 4> c{};
  double rest = 1.0;
  int shift = 2 * kQuatBits;
  for (std::size_t i = 0; i < 4; ++i) {
    if (i == largest) continue;
    const auto step = static_cast<double>(packed >> shift & kQuatMask);
    c[i] = (2.0 * step / kQuatSteps - 1.0) * kQuatRange;
    rest -= c[i] * c[i];
    shift -= kQuatBits;
  }
  c[largest] = std::sqrt(std::fmax(rest, 0.0));
  return Quat(c[3], c[0], c[1], c[2]).normalized();
}

// Components that are +0.0 are left out: most increments only move, or only turn.
void put(ByteWriter& out, const Increment& increment) {
  out.varint(increment.user.value);
  out.varint(increment.part.value);
  out.varint(increment.seq);
  std::uint8_t present = 0;
  for (int k = 0; k < 3; ++k) {
    if (std::bit_cast<std::uint64_t>(increment.translation_mm[k]) != 0)
      present = static_cast<std::uint8_t>(present | 1 << k);
    if (std::bit_cast<std::uint64_t>(increment.rotation_rad[k]) != 0)
      present = static_cast<std::uint8_t>(present | 8 << k);
  }
  out.u8(present);
  for (int k = 0; k < 6; ++k)
    if ((present >> k & 1) != 0)
      out.f64(k < 3 ? increment.translation_mm[k] : increment.rotation_rad[k - 3]);
}

Increment get_increment(ByteReader& in) {
  Increment increment;
  increment.user.value = in.varint32();
  increment.part.value = in.varint32();
  increment.seq = in.varint();
  const std::uint8_t present = in.u8();
  for (int k = 0; k < 6; ++k)
    if ((present >> k & 1) != 0)
      (k < 3 ? increment.translation_mm[k] : increment.rotation_rad[k - 3]) = in.f64();
  return increment;
}

constexpr std::uint64_t kLeastDecision = 4, kLeastIncrement = 4, kLeastPose = 22, kLeastRefused = 4;

}  // namespace

std::vector<std::byte> encode(std::uint64_t tick, std::span<const Decision> decisions) {
  ByteWriter out;
  out.varint(tick);
  out.varint(decisions.size());
  for (const Decision& decision : decisions) {
    out.u8(static_cast<std::uint8_t>(decision.kind));
    out.varint(decision.user.value);
    out.varint(decision.part.value);
    out.varint(decision.user_name.size());
    out.raw(decision.user_name);
  }
  return out.take();
}

bool decode(std::span<const std::byte> bytes, Decisions& out) {
  ByteReader in(bytes);
  out = {};
  out.tick = in.varint();
  const std::uint64_t count = in.varint();
  if (!in.room_for(count, kLeastDecision)) return false;
  for (std::uint64_t i = 0; i < count && in.ok(); ++i) {
    Decision decision;
    const std::uint8_t kind = in.u8();
    if (kind > static_cast<std::uint8_t>(Decision::Kind::kReset)) return false;
    decision.kind = static_cast<Decision::Kind>(kind);
    decision.user.value = in.varint32();
    decision.part.value = in.varint32();
    const auto name = in.raw(in.varint());
    decision.user_name.assign(reinterpret_cast<const char*>(name.data()), name.size());
    out.decisions.push_back(std::move(decision));
  }
  return in.at_end();
}

std::vector<std::byte> encode(std::uint64_t tick, std::span<const Increment> increments) {
  ByteWriter out;
  out.varint(tick);
  out.varint(increments.size());
  for (const Increment& increment : increments) put(out, increment);
  return out.take();
}

bool decode(std::span<const std::byte> bytes, Increments& out) {
  ByteReader in(bytes);
  out = {};
  out.tick = in.varint();
  const std::uint64_t count = in.varint();
  if (!in.room_for(count, kLeastIncrement)) return false;
  for (std::uint64_t i = 0; i < count && in.ok(); ++i) out.increments.push_back(get_increment(in));
  return in.at_end();
}

std::vector<std::byte> encode(std::uint64_t tick, std::span<const PartPose> poses) {
  ByteWriter out;
  out.varint(tick);
  out.varint(poses.size());
  for (const PartPose& pose : poses) {
    out.varint(pose.part.value);
    out.varint(pose.holder.value);
    for (int k = 0; k < 3; ++k) out.f32(static_cast<float>(pose.X_WP.p[k]));
    out.u64(pack(pose.X_WP.q));
  }
  return out.take();
}

bool decode(std::span<const std::byte> bytes, Poses& out) {
  ByteReader in(bytes);
  out = {};
  out.tick = in.varint();
  const std::uint64_t count = in.varint();
  if (!in.room_for(count, kLeastPose)) return false;
  for (std::uint64_t i = 0; i < count && in.ok(); ++i) {
    PartPose pose;
    pose.part.value = in.varint32();
    pose.holder.value = in.varint32();
    for (int k = 0; k < 3; ++k) pose.X_WP.p[k] = static_cast<double>(in.f32());
    pose.X_WP.q = unpack(in.u64());
    out.poses.push_back(pose);
  }
  return in.at_end();
}

std::vector<std::byte> encode_end(const StepReport& report, std::uint64_t tick) {
  ByteWriter out;
  out.varint(tick);
  out.u64(report.state_hash);
  out.varint(report.refused.size());
  for (const RefusedIncrement& refused : report.refused) {
    out.varint(refused.user.value);
    out.varint(refused.part.value);
    out.varint(refused.seq);
    out.u8(static_cast<std::uint8_t>(refused.reason));
  }
  return out.take();
}

bool decode(std::span<const std::byte> bytes, TickEnd& out) {
  ByteReader in(bytes);
  out = {};
  out.tick = in.varint();
  out.state_hash = in.u64();
  const std::uint64_t count = in.varint();
  if (!in.room_for(count, kLeastRefused)) return false;
  for (std::uint64_t i = 0; i < count && in.ok(); ++i) {
    RefusedIncrement refused;
    refused.user.value = in.varint32();
    refused.part.value = in.varint32();
    refused.seq = in.varint();
    const std::uint8_t reason = in.u8();
    if (reason >= kRefusalCount) return false;
    refused.reason = static_cast<Refusal>(reason);
    out.refused.push_back(refused);
  }
  return in.at_end();
}

std::vector<std::byte> encode(const TriangleMesh& mesh) {
  ByteWriter out;
  out.u32(static_cast<std::uint32_t>(mesh.points_mm.size()));
  out.u32(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Vec3& point : mesh.points_mm)
    for (int k = 0; k < 3; ++k) out.f64(point[k]);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) out.u32(corner);
  return out.take();
}

bool decode(std::span<const std::byte> bytes, TriangleMesh& out) {
  ByteReader in(bytes);
  const std::uint64_t points = in.u32(), triangles = in.u32();
  if (!in.ok() || in.left() != points * 24 + triangles * 12) return false;
  out.points_mm.resize(points);
  out.triangles.resize(triangles);
  for (Vec3& point : out.points_mm) {
    for (int k = 0; k < 3; ++k) point[k] = in.f64();
    if (!point.allFinite()) return false;
  }
  for (auto& triangle : out.triangles)
    for (std::uint32_t& corner : triangle)
      if (corner = in.u32(); corner >= points) return false;
  return in.at_end();
}

}  // namespace mortise::log_records
