#include <algorithm>

#include "idl/convert.h"
#include "idl/door.h"

namespace mortise {

Result<PartPose> from_wire(const wire::PartPose& in) {
  Door door("pose");
  door.need(in.part() != 0, "part");
  door.pose(in.q(), in.p_mm(), "pose");
  if (!door.open()) return door.refusal();
  return PartPose{PartId{in.part()}, UserId{in.holder()}, pose_of(in.q(), in.p_mm())};
}

Result<Ack> from_wire(const wire::Ack& in) {
  Door door("ack");
  door.need(in.user() != 0, "user");
  if (!door.open()) return door.refusal();
  return Ack{UserId{in.user()}, in.seq(), in.sent_ns()};
}

Result<PartInfo> from_wire(const wire::PartInfo& in) {
  Door door("part");
  door.need(in.part() != 0, "part");
  door.name(in.name(), "name");
  door.name(in.mesh_hash(), "mesh_hash");
  door.pose(in.q(), in.p_mm(), "pose");
  door.position(in.reference_mm(), "reference_mm");
  door.count(in.radius_mm(), "radius_mm");
  if (!door.open()) return door.refusal();
  PartInfo part;
  part.part = PartId{in.part()};
  part.name = in.name();
  part.mesh_hash = in.mesh_hash();
  part.moving = in.moving();
  part.holder = UserId{in.holder()};
  part.X_WP = pose_of(in.q(), in.p_mm());
  part.reference_P = vec3(in.reference_mm());
  part.radius_mm = in.radius_mm();
  return part;
}

Result<UserInfo> from_wire(const wire::UserInfo& in) {
  Door door("user");
  door.need(in.user() != 0, "user");
  door.name(in.name(), "name");
  if (!door.open()) return door.refusal();
  return UserInfo{UserId{in.user()}, in.name(), in.present()};
}

wire::Verdict to_wire(const Verdict& verdict) {
  wire::Verdict out;
  out.collision_class(static_cast<std::uint8_t>(verdict.collision_class));
  out.delta_and_gpd_mm(
      {verdict.delta_mm.lo, verdict.delta_mm.hi, verdict.gpd_mm.lo, verdict.gpd_mm.hi});
  out.fake_below_mm(verdict.fake_below_mm);
  out.real_above_mm(verdict.real_above_mm);
  out.margin_mm(verdict.margin_mm);
  out.probability(verdict.probability);
  out.travel_mm(verdict.travel_mm);
  out.normal_travel_mm(verdict.normal_travel_mm);
  out.point_mm(triple(verdict.point_W));
  out.normal(triple(verdict.normal_W));
  out.area_mm2(verdict.area_mm2);
  out.has_witness(verdict.has_witness);
  out.witness_mm(triple(verdict.witness_W));
  out.separation_translation_mm(triple(verdict.separation_translation_mm));
  out.separation_rotation_rad(triple(verdict.separation_rotation_rad));
  out.separation_way(static_cast<std::uint8_t>(verdict.separation_way));
  out.shape_a(static_cast<std::uint8_t>(verdict.shape_a));
  out.shape_b(static_cast<std::uint8_t>(verdict.shape_b));
  out.grade(static_cast<std::uint8_t>(verdict.grade));
  out.face_a(clip(verdict.face_a, kMaxName_bytes));
  out.face_b(clip(verdict.face_b, kMaxName_bytes));
  out.explanation(clip(verdict.explanation, kMaxText_bytes));
  return out;
}

// Brackets, thresholds and the margin may be unbounded (nothing known, nothing declared), but are
// numbers.
Result<Verdict> from_wire(const wire::Verdict& in) {
  constexpr auto kShapes = static_cast<std::uint8_t>(FaceShape::kEdge);
  const wire::Quadruple& brackets = in.delta_and_gpd_mm();
  Door door("verdict");
  door.need(in.collision_class() <= static_cast<std::uint8_t>(CollisionClass::kReal), "class");
  door.interval(brackets[0], brackets[1], "delta_mm");
  door.interval(brackets[2], brackets[3], "gpd_mm");
  door.number(in.fake_below_mm(), "fake_below_mm");
  door.number(in.real_above_mm(), "real_above_mm");
  door.number(in.margin_mm(), "margin_mm");
  door.need(in.probability() >= 0.0 && in.probability() <= 1.0, "probability");
  door.finite(in.travel_mm(), "travel_mm");
  door.finite(in.normal_travel_mm(), "normal_travel_mm");
  door.position(in.point_mm(), "point_mm");
  door.vector(in.normal(), "normal");
  door.count(in.area_mm2(), "area_mm2");
  door.position(in.witness_mm(), "witness_mm");
  door.position(in.separation_translation_mm(), "separation_translation_mm");
  door.vector(in.separation_rotation_rad(), "separation_rotation_rad");
  door.need(in.separation_way() <= static_cast<std::uint8_t>(SeparationWay::kAxis),
            "separation_way");
  door.need(in.shape_a() <= kShapes && in.shape_b() <= kShapes, "shape");
  door.need(in.grade() <= static_cast<std::uint8_t>(DeviationGrade::kNominal), "grade");
  door.name(in.face_a(), "face_a");
  door.name(in.face_b(), "face_b");
  door.text(in.explanation(), "explanation");
  if (!door.open()) return door.refusal();
  Verdict verdict;
  verdict.collision_class = static_cast<CollisionClass>(in.collision_class());
  verdict.delta_mm = {brackets[0], brackets[1]};
  verdict.gpd_mm = {brackets[2], brackets[3]};
  verdict.fake_below_mm = in.fake_below_mm();
  verdict.real_above_mm = in.real_above_mm();
  verdict.margin_mm = in.margin_mm();
  verdict.probability = in.probability();
  verdict.travel_mm = in.travel_mm();
  verdict.normal_travel_mm = in.normal_travel_mm();
  verdict.point_W = vec3(in.point_mm());
  verdict.normal_W = vec3(in.normal());
  verdict.area_mm2 = in.area_mm2();
  verdict.has_witness = in.has_witness();
  verdict.witness_W = vec3(in.witness_mm());
  verdict.separation_translation_mm = vec3(in.separation_translation_mm());
  verdict.separation_rotation_rad = vec3(in.separation_rotation_rad());
  verdict.separation_way = static_cast<SeparationWay>(in.separation_way());
  verdict.shape_a = static_cast<FaceShape>(in.shape_a());
  verdict.shape_b = static_cast<FaceShape>(in.shape_b());
  verdict.grade = static_cast<DeviationGrade>(in.grade());
  verdict.face_a = in.face_a();
  verdict.face_b = in.face_b();
  verdict.explanation = in.explanation();
  return verdict;
}

wire::PartPose to_wire(const PartPose& pose) {
  wire::PartPose out;
  out.part(pose.part.value);
  out.holder(pose.holder.value);
  out.q(quadruple(pose.X_WP.q));
  out.p_mm(triple(pose.X_WP.p));
  return out;
}

wire::Ack to_wire(const Ack& ack) {
  wire::Ack out;
  out.user(ack.user.value);
  out.seq(ack.seq);
  out.sent_ns(ack.sent_ns);
  return out;
}

Result<PoseBatch> from_wire(const wire::PoseBatch& in) {
  PoseBatch batch;
  batch.tick = in.tick();
  batch.event_seq = in.event_seq();
  batch.sent_ns = in.sent_ns();
  if (Status read = read_all(in.parts(), batch.parts); !read) return read.error();
  if (Status read = read_all(in.acks(), batch.acks); !read) return read.error();
  return batch;
}

wire::ClashEvent to_wire(const ClashEvent& event) {
  wire::ClashEvent out;
  out.kind(static_cast<std::uint8_t>(event.kind));
  out.seq(event.seq);
  out.tick(event.tick);
  out.clash(event.clash.value);
  out.part_a(event.part_a.value);
  out.part_b(event.part_b.value);
  out.user(event.user.value);
  out.t_contact(event.t_contact);
  out.t_potential(event.t_potential);
  out.t_real(event.t_real);
  out.begin_tick(event.begin_tick);
  out.worst_class(static_cast<std::uint8_t>(event.worst_class));
  out.worst_delta_lo_mm(event.worst_delta_mm.lo);
  out.worst_delta_hi_mm(event.worst_delta_mm.hi);
  out.verdict(to_wire(event.verdict));
  return out;
}

Result<ClashEvent> from_wire(const wire::ClashEvent& in) {
  Door door("clash event");
  door.need(in.kind() != 0 && in.kind() <= static_cast<std::uint8_t>(ClashEvent::Kind::kReview),
            "kind");
  door.need(in.seq() != 0, "seq");
  door.need(in.clash() != 0, "clash");
  door.need(in.part_a() != 0 && in.part_a() < in.part_b(), "parts");
  door.need(in.t_contact() >= 0.0 && in.t_contact() <= 1.0, "t_contact");
  const auto within_tick = [](double t) { return (t >= 0.0 && t <= 1.0) || t == kNever; };
  door.need(within_tick(in.t_potential()), "t_potential");
  door.need(within_tick(in.t_real()), "t_real");
  door.need(in.begin_tick() <= in.tick(), "begin_tick");
  door.need(in.worst_class() <= static_cast<std::uint8_t>(CollisionClass::kReal), "worst_class");
  door.interval(in.worst_delta_lo_mm(), in.worst_delta_hi_mm(), "worst_delta_mm");
  if (!door.open()) return door.refusal();
  Result<Verdict> verdict = from_wire(in.verdict());
  if (!verdict) return verdict.error();
  ClashEvent event;
  event.kind = static_cast<ClashEvent::Kind>(in.kind());
  event.seq = in.seq();
  event.tick = in.tick();
  event.clash = ClashId{in.clash()};
  event.part_a = PartId{in.part_a()};
  event.part_b = PartId{in.part_b()};
  event.user = UserId{in.user()};
  event.verdict = std::move(verdict.value());
  event.t_contact = in.t_contact();
  event.t_potential = in.t_potential();
  event.t_real = in.t_real();
  event.begin_tick = in.begin_tick();
  event.worst_class = static_cast<CollisionClass>(in.worst_class());
  event.worst_delta_mm = {in.worst_delta_lo_mm(), in.worst_delta_hi_mm()};
  return event;
}

wire::PartInfo to_wire(const PartInfo& part) {
  wire::PartInfo out;
  out.part(part.part.value);
  out.holder(part.holder.value);
  out.moving(part.moving);
  out.name(clip(part.name, kMaxName_bytes));
  out.mesh_hash(clip(part.mesh_hash, kMaxName_bytes));
  out.q(quadruple(part.X_WP.q));
  out.p_mm(triple(part.X_WP.p));
  out.reference_mm(triple(part.reference_P));
  out.radius_mm(part.radius_mm);
  return out;
}

wire::UserInfo to_wire(const UserInfo& user) {
  wire::UserInfo out;
  out.user(user.user.value);
  out.present(user.present);
  out.name(clip(user.name, kMaxName_bytes));
  return out;
}

Result<Snapshot> from_wire(const wire::Snapshot& in) {
  Door door("snapshot");
  door.need(std::isfinite(in.tick_rate_hz()) && in.tick_rate_hz() > 0.0, "tick_rate_hz");
  door.name(in.session(), "session");
  door.name(in.policy(), "policy");
  if (!door.open()) return door.refusal();
  Snapshot snapshot;
  snapshot.session = in.session();
  snapshot.tick = in.tick();
  snapshot.event_seq = in.event_seq();
  snapshot.tick_rate_hz = in.tick_rate_hz();
  snapshot.policy = in.policy();
  if (Status read = read_all(in.parts(), snapshot.parts); !read) return read.error();
  if (Status read = read_all(in.users(), snapshot.users); !read) return read.error();
  if (Status read = read_all(in.open_clashes(), snapshot.open_clashes); !read) return read.error();
  if (Status read = read_all(in.standing(), snapshot.standing); !read) return read.error();
  door.need(in.roles().size() == in.users().size(), "roles");
  door.need(in.clash_notes().size() == in.open_clashes().size(), "clash_notes");
  for (const std::uint8_t role : in.roles()) door.need(role < kRoleCount, "roles");
  if (!door.open()) return door.refusal();
  for (std::size_t i = 0; i < snapshot.users.size(); ++i)
    snapshot.users[i].role = static_cast<Role>(in.roles()[i]);
  for (std::size_t i = 0; i < snapshot.open_clashes.size(); ++i)
    if (Status noted = add_note(in.clash_notes()[i], snapshot.open_clashes[i]); !noted)
      return noted.error();
  return snapshot;
}

wire::Pulse to_wire(const SessionPulse& pulse, std::uint64_t pose_serial) {
  wire::Pulse out;
  out.tick(pulse.tick);
  std::copy(std::begin(pulse.clashes_open), std::end(pulse.clashes_open),
            out.clashes_open().begin());
  std::copy(std::begin(pulse.clashes_total), std::end(pulse.clashes_total),
            out.clashes_total().begin());
  out.tick_p50_us(pulse.tick_p50_us);
  out.tick_p99_us(pulse.tick_p99_us);
  out.tick_max_us(pulse.tick_max_us);
  out.lateness_p99_us(pulse.lateness_p99_us);
  out.missed_deadlines(pulse.missed_deadlines);
  out.refused(pulse.refused);
  out.not_examined(pulse.not_examined);
  out.users(pulse.users);
  out.pose_serial(pose_serial);
  out.draining(pulse.draining);
  return out;
}

Result<SessionPulse> from_wire(const wire::Pulse& in) {
  Door door("pulse");
  door.count(in.tick_p50_us(), "tick_p50_us");
  door.count(in.tick_p99_us(), "tick_p99_us");
  door.count(in.tick_max_us(), "tick_max_us");
  door.count(in.lateness_p99_us(), "lateness_p99_us");
  if (!door.open()) return door.refusal();
  SessionPulse pulse;
  pulse.tick = in.tick();
  std::copy(in.clashes_open().begin(), in.clashes_open().end(), std::begin(pulse.clashes_open));
  std::copy(in.clashes_total().begin(), in.clashes_total().end(), std::begin(pulse.clashes_total));
  pulse.tick_p50_us = in.tick_p50_us();
  pulse.tick_p99_us = in.tick_p99_us();
  pulse.tick_max_us = in.tick_max_us();
  pulse.lateness_p99_us = in.lateness_p99_us();
  pulse.missed_deadlines = in.missed_deadlines();
  pulse.refused = in.refused();
  pulse.not_examined = in.not_examined();
  pulse.users = in.users();
  pulse.draining = in.draining();
  return pulse;
}

}  // namespace mortise
