#include "common/io/log/log_records.h"

#include <array>
#include <bit>
#include <cmath>

#include "common/base/constants.h"
#include "common/io/scenario/brought_part.h"
#include "common/io/state/bytes.h"

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

void put(ByteWriter& out, const std::string& text) {
  out.varint(text.size());
  out.raw(text);
}

std::string get_text(ByteReader& in) { return in.text(in.varint()); }

// Most decisions say nothing of a constraint: one byte.
void put(ByteWriter& out, const Constraint& constraint) {
  out.u8(static_cast<std::uint8_t>(constraint.kind));
  if (constraint.kind == ConstraintKind::kUnknown) return;
  for (const FeatureOf& end : {constraint.held, constraint.other}) {
    out.varint(end.part.value);
    put(out, end.feature);
  }
  out.f64(constraint.distance_mm);
  out.u8(constraint.snap ? 1 : 0);
}

bool get_constraint(ByteReader& in, Constraint& constraint) {
  const std::uint8_t kind = in.u8();
  if (kind >= kConstraintKindCount) return false;
  constraint.kind = static_cast<ConstraintKind>(kind);
  if (constraint.kind == ConstraintKind::kUnknown) return in.ok();
  for (FeatureOf* end : {&constraint.held, &constraint.other}) {
    end->part.value = in.varint32();
    end->feature = get_text(in);
  }
  constraint.distance_mm = in.f64();
  constraint.snap = in.u8() != 0;
  return in.ok();
}

void put(ByteWriter& out, const PartEdit& edit) {
  put(out, edit.name);
  put(out, edit.mesh_hash);
  for (int i = 0; i < 4; ++i) out.f64(edit.X_WP.q.coeffs()[i]);
  for (int i = 0; i < 3; ++i) out.f64(edit.X_WP.p[i]);
  out.u8(edit.moving);
  out.f64(edit.quantum_mm);
}

void get_edit(ByteReader& in, PartEdit& edit) {
  edit.name = get_text(in);
  edit.mesh_hash = get_text(in);
  for (int i = 0; i < 4; ++i) edit.X_WP.q.coeffs()[i] = in.f64();
  for (int i = 0; i < 3; ++i) edit.X_WP.p[i] = in.f64();
  edit.moving = in.u8() != 0;
  edit.quantum_mm = in.f64();
}

// Kinds of format 1 are written as they were then; the high bit of the kind says that more follows.
constexpr std::uint8_t kHasDetails = 0x80;

void put(ByteWriter& out, const Decision& decision) {
  const Details& d = decision.details;
  out.u8(static_cast<std::uint8_t>(static_cast<std::uint8_t>(decision.kind) | kHasDetails));
  out.varint(decision.user.value);
  out.varint(decision.part.value);
  put(out, decision.user_name);
  out.u8(static_cast<std::uint8_t>(decision.role));
  out.varint(d.parts.size());
  for (const PartId part : d.parts) out.varint(part.value);
  out.varint(d.other_part.value);
  put(out, d.feature);
  put(out, d.other_feature);
  out.varint(d.other_user.value);
  out.varint(d.clash.value);
  out.u8(static_cast<std::uint8_t>(d.status));
  put(out, d.text);
  put(out, d.constraint);
  out.varint(d.constraint_id.value);
  if (edits_scene(decision.kind)) put(out, d.edit.value_or(PartEdit{}));
}

bool get_details(ByteReader& in, Decision& decision) {
  Details& d = decision.details;
  const std::uint8_t role = in.u8();
  const std::uint64_t parts = in.varint();
  if (role >= kRoleCount || !in.room_for(parts, 1)) return false;
  decision.role = static_cast<Role>(role);
  for (std::uint64_t i = 0; i < parts; ++i) d.parts.push_back(PartId{in.varint32()});
  d.other_part.value = in.varint32();
  d.feature = get_text(in);
  d.other_feature = get_text(in);
  d.other_user.value = in.varint32();
  d.clash.value = in.varint32();
  const std::uint8_t status = in.u8();
  if (status >= kReviewStatusCount) return false;
  d.status = static_cast<ReviewStatus>(status);
  d.text = get_text(in);
  if (!get_constraint(in, d.constraint)) return false;
  d.constraint_id.value = in.varint32();
  if (edits_scene(decision.kind)) get_edit(in, d.edit.emplace());
  return in.ok() && (!d.edit || (valid(d.edit->X_WP) && d.edit->quantum_mm >= 0.0));
}

bool get_decision(ByteReader& in, Decision& decision) {
  const std::uint8_t byte = in.u8();
  const auto kind = static_cast<std::uint8_t>(byte & ~kHasDetails);
  if (kind >= kDecisionKindCount) return false;
  decision.kind = static_cast<Decision::Kind>(kind);
  decision.user.value = in.varint32();
  decision.part.value = in.varint32();
  decision.user_name = get_text(in);
  return (byte & kHasDetails) == 0 ? in.ok() : get_details(in, decision);
}

// Bytes that one record takes at least: no count in a damaged file may ask for more memory than its
// bytes can fill.
constexpr std::uint64_t kLeastDecision = 4, kLeastIncrement = 4, kLeastPose = 22, kLeastRefused = 4;

}  // namespace

std::vector<std::byte> encode(std::uint64_t tick, std::span<const Decision> decisions) {
  ByteWriter out;
  out.varint(tick);
  out.varint(decisions.size());
  for (const Decision& decision : decisions) put(out, decision);
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
    if (!get_decision(in, decision)) return false;
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
    if (!valid(pose.X_WP)) return false;
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
  if (mesh.stated) {  // which holds the mesh as well
    out.raw(*mesh.stated);
    return out.take();
  }
  out.u32(static_cast<std::uint32_t>(mesh.points_mm.size()));
  out.u32(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Vec3& point : mesh.points_mm)
    for (int k = 0; k < 3; ++k) out.f64(point[k]);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) out.u32(corner);
  return out.take();
}

bool decode(std::span<const std::byte> bytes, TriangleMesh& out) {
  if (is_step_document(bytes)) {
    Result<TriangleMesh> brought = brought_mesh({bytes.begin(), bytes.end()});
    if (brought) out = std::move(brought).value();
    return static_cast<bool>(brought);
  }
  ByteReader in(bytes);
  const std::uint64_t points = in.u32(), triangles = in.u32();
  if (!in.ok() || in.left() != points * 24 + triangles * 12) return false;
  out.points_mm.resize(points);
  out.triangles.resize(triangles);
  for (Vec3& point : out.points_mm) {
    for (int k = 0; k < 3; ++k) point[k] = in.f64();
    if (!(point.array().abs() <= kLargestCoordinate_mm).all()) return false;
  }
  for (auto& triangle : out.triangles)
    for (std::uint32_t& corner : triangle)
      if (corner = in.u32(); corner >= points) return false;
  return in.at_end();
}

}  // namespace mortise::log_records
