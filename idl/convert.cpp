#include "idl/convert.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/constants.h"
#include "idl/door.h"

namespace mortise {
bool text_ok(const std::string& text, std::size_t limit) {
  return text.size() <= limit && is_text(text);
}

std::string clip(const std::string& text, std::size_t limit) {
  std::string out = is_text(text) ? text : one_line(text);
  if (out.size() > limit) {
    out.resize(limit);
    out.resize(utf8_prefix(out));
  }
  return out;
}

// ---- increments

wire::IncrementBatch to_wire(const IncrementBatch& batch) {
  wire::IncrementBatch out;
  out.kept_from(batch.kept_from);
  out.fresh_from(batch.fresh_from);
  for (const auto& [increment, sent_ns] : batch.increments) {
    out.user(increment.user.value);
    wire::Increment& entry = out.increments().emplace_back();
    entry.part(increment.part.value);
    entry.seq(increment.seq);
    entry.sent_ns(sent_ns);
    entry.translation_mm(triple(increment.translation_mm));
    entry.rotation_rad(triple(increment.rotation_rad));
  }
  return out;
}

namespace {

Refusal refusal_at_door(const Increment& increment) {
  if (!increment.part) return Refusal::kUnknownPart;
  if (increment.seq == 0) return Refusal::kStale;
  return refusal_of(increment, kMaxCoordinate_mm);
}

}  // namespace

Result<std::vector<ReceivedIncrement>> from_wire(const wire::IncrementBatch& in) {
  const std::vector<wire::Increment>& entries = in.increments();
  const auto not_rising = [](const wire::Increment& a, const wire::Increment& b) {
    return a.seq() >= b.seq();
  };
  Door door("increments");
  door.need(in.user() != 0, "user");
  door.need(!entries.empty() && entries.size() <= kMaxBatchIncrements, "number");
  door.need(std::adjacent_find(entries.begin(), entries.end(), not_rising) == entries.end(), "seq");
  door.need(entries.empty() || in.kept_from() <= entries.front().seq(), "kept_from");
  if (!door.open()) return door.refusal();
  std::vector<ReceivedIncrement> out;
  out.reserve(entries.size());
  for (const wire::Increment& entry : entries) {
    ReceivedIncrement& r = out.emplace_back();
    r.increment.user = UserId{in.user()};
    r.increment.part = PartId{entry.part()};
    r.increment.seq = entry.seq();
    r.kept_from = in.kept_from();
    r.repeated = entry.seq() < in.fresh_from();
    r.increment.translation_mm = vec3(entry.translation_mm());
    r.increment.rotation_rad = vec3(entry.rotation_rad());
    r.at_door = refusal_at_door(r.increment);
    if (r.at_door != Refusal::kNone) {
      r.increment.translation_mm = r.increment.rotation_rad = Vec3::Zero();
      continue;
    }
    r.sent_ns = entry.sent_ns();
  }
  return out;
}

// ---- what commands and decisions say beside their kind, user and part

namespace {

wire::FeatureOf to_wire(const FeatureOf& feature) {
  wire::FeatureOf out;
  out.part(feature.part.value);
  out.feature(clip(feature.feature, kMaxName_bytes));
  return out;
}

FeatureOf feature_of(const wire::FeatureOf& in) { return {PartId{in.part()}, in.feature()}; }

wire::Constraint to_wire(const Constraint& constraint) {
  wire::Constraint out;
  out.kind(static_cast<std::uint8_t>(constraint.kind));
  out.held(to_wire(constraint.held));
  out.other(to_wire(constraint.other));
  out.distance_mm(constraint.distance_mm);
  out.snap(constraint.snap);
  return out;
}

bool says_anything(const Constraint& constraint) {
  return constraint.kind != ConstraintKind::kUnknown || constraint.held.part ||
         constraint.other.part;
}

wire::PartEdit to_wire(const PartEdit& edit) {
  wire::PartEdit out;
  out.name(clip(edit.name, kMaxName_bytes));
  out.mesh_hash(clip(edit.mesh_hash, kMaxName_bytes));
  out.pose(wire_pose(edit.X_WP));
  out.moving(edit.moving);
  out.quantum_mm(edit.quantum_mm);
  return out;
}

Result<PartEdit> from_wire(const wire::PartEdit& in) {
  Door door("edit of a part");
  door.name(in.name(), "name");
  door.name(in.mesh_hash(), "mesh_hash");
  door.pose(in.pose(), "pose");
  door.count(in.quantum_mm(), "quantum_mm");
  if (!door.open()) return door.refusal();
  return PartEdit{in.name(), in.mesh_hash(), pose_of(in.pose()), in.moving(), in.quantum_mm()};
}

wire::Details to_wire(const Details& details) {
  wire::Details out;
  for (const PartId part : details.parts) out.parts().push_back(part.value);
  if (details.other_part || !details.feature.empty() || !details.other_feature.empty()) {
    wire::PairDetails& pair = out.pair().emplace_back();
    pair.feature(clip(details.feature, kMaxName_bytes));
    pair.other(to_wire(FeatureOf{details.other_part, details.other_feature}));
  }
  if (details.clash) {
    wire::ReviewDetails& review = out.review().emplace_back();
    review.clash(details.clash.value);
    review.status(static_cast<std::uint8_t>(details.status));
  }
  if (says_anything(details.constraint)) out.constraint().push_back(to_wire(details.constraint));
  out.constraint_id(details.constraint_id.value);
  out.other_user(details.other_user.value);
  out.text(clip(details.text, kMaxText_bytes));
  if (details.edit) out.edit().push_back(to_wire(*details.edit));
  return out;
}

Result<Details> from_wire(const wire::Details& in) {
  Door door("details");
  door.need(in.parts().size() <= kMostGroupParts, "parts");
  for (const std::uint32_t part : in.parts()) door.need(part != 0, "parts");
  door.at_most_one(in.pair(), "pair");
  for (const wire::PairDetails& pair : in.pair()) {
    door.name(pair.feature(), "feature");
    door.name(pair.other().feature(), "other feature");
  }
  door.at_most_one(in.review(), "review");
  for (const wire::ReviewDetails& review : in.review())
    door.need(review.status() < kReviewStatusCount, "status");
  door.at_most_one(in.constraint(), "constraint");
  for (const wire::Constraint& constraint : in.constraint()) {
    door.need(constraint.kind() < kConstraintKindCount, "constraint");
    door.need(std::abs(constraint.distance_mm()) <= kMaxCoordinate_mm, "distance_mm");
    door.name(constraint.held().feature(), "held feature");
    door.name(constraint.other().feature(), "other feature");
  }
  door.text(in.text(), "text");
  door.at_most_one(in.edit(), "edit");
  if (!door.open()) return door.refusal();
  Details details;
  for (const wire::PartEdit& edit : in.edit()) {
    Result<PartEdit> ours = from_wire(edit);
    if (!ours) return ours.error();
    details.edit = std::move(*ours);
  }
  for (const std::uint32_t part : in.parts()) details.parts.push_back(PartId{part});
  for (const wire::PairDetails& pair : in.pair()) {
    details.feature = pair.feature();
    details.other_part = PartId{pair.other().part()};
    details.other_feature = pair.other().feature();
  }
  for (const wire::ReviewDetails& review : in.review()) {
    details.clash = ClashId{review.clash()};
    details.status = static_cast<ReviewStatus>(review.status());
  }
  for (const wire::Constraint& constraint : in.constraint())
    details.constraint = {static_cast<ConstraintKind>(constraint.kind()),
                          feature_of(constraint.held()), feature_of(constraint.other()),
                          constraint.distance_mm(), constraint.snap()};
  details.constraint_id = ConstraintId{in.constraint_id()};
  details.other_user = UserId{in.other_user()};
  details.text = in.text();
  return details;
}

wire::Command to_wire(const Command& command) {
  wire::Command out;
  out.kind(static_cast<std::uint8_t>(command.kind));
  out.user(command.user.value);
  out.part(command.part.value);
  out.seq(command.seq);
  out.after(command.after);
  out.details(to_wire(command.details));
  return out;
}

Result<Command> from_wire(const wire::Command& in) {
  Door door("command");
  door.need(in.user() != 0, "user");
  door.need(in.kind() != 0 && in.kind() < kCommandKindCount, "kind");
  if (!door.open()) return door.refusal();
  Result<Details> details = from_wire(in.details());
  if (!details) return details.error();
  return Command{
      UserId{in.user()},   PartId{in.part()}, in.seq(), static_cast<CommandKind>(in.kind()),
      std::move(*details), in.after()};
}

}  // namespace

wire::Decision to_wire(const Decision& decision) {
  wire::Decision out;
  out.kind(static_cast<std::uint8_t>(decision.kind));
  out.user(decision.user.value);
  out.part(decision.part.value);
  out.role(static_cast<std::uint8_t>(decision.role));
  out.user_name(clip(decision.user_name, kMaxName_bytes));
  out.details(to_wire(decision.details));
  return out;
}

Result<Decision> from_wire(const wire::Decision& in) {
  Door door("decision");
  door.need(in.kind() != 0 && in.kind() < kDecisionKindCount, "kind");
  door.need(in.role() < kRoleCount, "role");
  door.name(in.user_name(), "user_name");
  if (!door.open()) return door.refusal();
  Result<Details> details = from_wire(in.details());
  if (!details) return details.error();
  return Decision{
      static_cast<Decision::Kind>(in.kind()), UserId{in.user()},  PartId{in.part()}, in.user_name(),
      static_cast<Role>(in.role()),           std::move(*details)};
}

wire::StandingChange to_wire(const StandingChange& change) {
  wire::StandingChange out;
  out.tick(change.tick);
  out.holds(change.holds);
  out.decision(to_wire(change.decision));
  return out;
}

Result<StandingChange> from_wire(const wire::StandingChange& in) {
  Result<Decision> decision = from_wire(in.decision());
  if (!decision) return decision.error();
  return StandingChange{in.tick(), in.holds(), std::move(*decision)};
}

// ---- requests and answers

namespace {

wire::UploadPiece to_wire(const UploadPiece& piece) {
  wire::UploadPiece out;
  out.user(piece.user.value);
  out.upload(piece.upload);
  out.name(clip(piece.name, kMaxName_bytes));
  out.unit_mm(piece.unit_mm);
  out.hash(clip(piece.hash, kMaxName_bytes));
  out.length(piece.length);
  out.offset(piece.offset);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(piece.bytes.data());
  out.bytes().assign(bytes, bytes + piece.bytes.size());
  return out;
}

Result<UploadPiece> from_wire(const wire::UploadPiece& in) {
  Door door("upload");
  door.need(in.user() != 0, "user");
  door.need(in.upload() != 0, "upload");
  door.name(in.name(), "name");
  door.need(std::isfinite(in.unit_mm()) && in.unit_mm() > 0.0, "unit_mm");
  door.name(in.hash(), "hash");
  door.need(!in.bytes().empty() && in.bytes().size() <= kUploadPiece_bytes, "bytes");
  door.need(in.offset() <= in.length() && in.bytes().size() <= in.length() - in.offset(), "offset");
  if (!door.open()) return door.refusal();
  const auto* bytes = reinterpret_cast<const std::byte*>(in.bytes().data());
  return UploadPiece{
      UserId{in.user()}, in.upload(), in.name(),   in.unit_mm(),
      in.hash(),         in.length(), in.offset(), {bytes, bytes + in.bytes().size()}};
}

}  // namespace

wire::Request to_wire(const Request& request) {
  wire::Request out;
  switch (request.kind) {
    case Request::Kind::kJoin: {
      wire::JoinRequest& join = out.join().emplace_back();
      join.nonce(request.nonce);
      join.name(clip(request.name, kMaxName_bytes));
      join.role(clip(request.role, kMaxName_bytes));
      break;
    }
    case Request::Kind::kLeave:
      out.leave().emplace_back().user(request.command.user.value);
      break;
    case Request::Kind::kCommand:
      out.command().push_back(to_wire(request.command));
      break;
    case Request::Kind::kSnapshot:
      out.snapshot(true);
      break;
    case Request::Kind::kUpload:
      out.upload().push_back(to_wire(request.piece));
      break;
    case Request::Kind::kUnknown:
      break;
  }
  return out;
}

Result<Request> from_wire(const wire::Request& in) {
  Door door("request");
  door.need(in.join().size() + in.leave().size() + in.command().size() + in.snapshot() +
                    in.upload().size() ==
                1,
            "number");
  for (const wire::JoinRequest& join : in.join()) {
    door.need(!join.name().empty() && text_ok(join.name(), kMaxName_bytes), "name");
    door.need(role_named(join.role()).has_value(), "role");
  }
  for (const wire::LeaveRequest& leave : in.leave()) door.need(leave.user() != 0, "user");
  if (!door.open()) return door.refusal();
  Request request;
  if (!in.join().empty()) {
    request.kind = Request::Kind::kJoin;
    request.nonce = in.join()[0].nonce();
    request.name = in.join()[0].name();
    request.role = in.join()[0].role();
  } else if (!in.leave().empty()) {
    request.kind = Request::Kind::kLeave;
    request.command.user = UserId{in.leave()[0].user()};
  } else if (!in.command().empty()) {
    Result<Command> command = from_wire(in.command()[0]);
    if (!command) return command.error();
    request.kind = Request::Kind::kCommand;
    request.command = std::move(*command);
  } else if (!in.upload().empty()) {
    Result<UploadPiece> piece = from_wire(in.upload()[0]);
    if (!piece) return piece.error();
    request.kind = Request::Kind::kUpload;
    request.piece = std::move(*piece);
  } else {
    request.kind = Request::Kind::kSnapshot;
  }
  return request;
}

Result<JoinReply> from_wire(const wire::JoinReply& in) {
  Door door("join reply");
  door.need(in.refusal() < kRefusalCount, "refusal");
  door.need((in.refusal() == 0) == (in.user() != 0), "user");
  door.name(in.client(), "client");
  door.text(in.text(), "text");
  if (!door.open()) return door.refusal();
  return JoinReply{in.client(), in.nonce(), UserId{in.user()}, static_cast<Refusal>(in.refusal()),
                   in.text()};
}

Result<Reply> from_wire(const wire::Reply& in) {
  Door door("reply");  // of no user: who asked has not joined
  door.need(in.refusal() < kRefusalCount, "refusal");
  door.text(in.text(), "text");
  if (!door.open()) return door.refusal();
  Reply reply;
  reply.user = UserId{in.user()};
  reply.part = PartId{in.part()};
  reply.seq = in.seq();
  reply.refusal = static_cast<Refusal>(in.refusal());
  reply.holder = UserId{in.holder()};
  reply.text = in.text();
  return reply;
}

Result<RefusedIncrement> from_wire(const wire::RefusedIncrement& in) {
  Door door("refused increment");
  door.need(in.reason() < kRefusalCount && in.reason() != 0, "reason");
  if (!door.open()) return door.refusal();
  return RefusedIncrement{UserId{in.user()}, PartId{in.part()}, in.seq(),
                          static_cast<Refusal>(in.reason())};
}

Result<UploadState> from_wire(const wire::UploadState& in) {
  Door door("state of an upload");
  door.need(in.refusal() < kRefusalCount, "refusal");
  door.name(in.mesh_hash(), "mesh_hash");
  door.text(in.text(), "text");
  if (!door.open()) return door.refusal();
  return UploadState{UserId{in.user()},
                     in.upload(),
                     in.received(),
                     in.ready(),
                     in.mesh_hash(),
                     in.text(),
                     static_cast<Refusal>(in.refusal())};
}

wire::Answers to_wire(std::span<const JoinReply> joins, std::span<const Reply> replies,
                      std::span<const RefusedIncrement> refused,
                      std::span<const Decision> decisions, std::span<const StandingChange> standing,
                      std::span<const UploadState> uploads) {
  wire::Answers out;
  for (const UploadState& upload : uploads) {
    wire::UploadState& entry = out.uploads().emplace_back();
    entry.user(upload.user.value);
    entry.upload(upload.upload);
    entry.received(upload.received);
    entry.ready(upload.ready);
    entry.mesh_hash(clip(upload.mesh_hash, kMaxName_bytes));
    entry.text(clip(upload.text, kMaxText_bytes));
    entry.refusal(static_cast<std::uint8_t>(upload.refusal));
  }
  for (const Decision& decision : decisions) out.decisions().push_back(to_wire(decision));
  for (const StandingChange& change : standing) out.standing().push_back(to_wire(change));
  for (const JoinReply& reply : joins) {
    wire::JoinReply& entry = out.joins().emplace_back();
    entry.client(clip(reply.client, kMaxName_bytes));
    entry.nonce(reply.nonce);
    entry.user(reply.user.value);
    entry.refusal(static_cast<std::uint8_t>(reply.refusal));
    entry.text(clip(reply.text, kMaxText_bytes));
  }
  for (const Reply& reply : replies) {
    wire::Reply& entry = out.replies().emplace_back();
    entry.user(reply.user.value);
    entry.part(reply.part.value);
    entry.seq(reply.seq);
    entry.refusal(static_cast<std::uint8_t>(reply.refusal));
    entry.holder(reply.holder.value);
    entry.text(clip(reply.text, kMaxText_bytes));
  }
  for (const RefusedIncrement& refusal : refused) {
    wire::RefusedIncrement& entry = out.refused().emplace_back();
    entry.user(refusal.user.value);
    entry.part(refusal.part.value);
    entry.seq(refusal.seq);
    entry.reason(static_cast<std::uint8_t>(refusal.reason));
  }
  return out;
}

Result<Answers> from_wire(const wire::Answers& in) {
  Answers answers;
  if (Status read = read_all(in.joins(), answers.joins); !read) return read.error();
  if (Status read = read_all(in.replies(), answers.replies); !read) return read.error();
  if (Status read = read_all(in.refused(), answers.refused); !read) return read.error();
  if (Status read = read_all(in.decisions(), answers.decisions); !read) return read.error();
  if (Status read = read_all(in.standing(), answers.standing); !read) return read.error();
  if (Status read = read_all(in.uploads(), answers.uploads); !read) return read.error();
  return answers;
}

// ---- poses, clashes, snapshots

Result<PartPose> from_wire(const wire::PartPose& in) {
  Door door("pose");
  door.need(in.part() != 0, "part");
  door.pose(in.pose(), "pose");
  if (!door.open()) return door.refusal();
  return PartPose{PartId{in.part()}, UserId{in.holder()}, pose_of(in.pose())};
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
  door.pose(in.pose(), "pose");
  door.position(in.reference_mm(), "reference_mm");
  door.count(in.radius_mm(), "radius_mm");
  if (!door.open()) return door.refusal();
  PartInfo part;
  part.part = PartId{in.part()};
  part.name = in.name();
  part.mesh_hash = in.mesh_hash();
  part.moving = in.moving();
  part.holder = UserId{in.holder()};
  part.X_WP = pose_of(in.pose());
  part.reference_P = vec3(in.reference_mm());
  part.radius_mm = in.radius_mm();
  return part;
}

Result<UserInfo> from_wire(const wire::UserInfo& in) {
  Door door("user");
  door.need(in.user() != 0, "user");
  door.need(in.role() < kRoleCount, "role");
  door.name(in.name(), "name");
  if (!door.open()) return door.refusal();
  return UserInfo{UserId{in.user()}, in.name(), in.present(), static_cast<Role>(in.role())};
}

wire::Verdict to_wire(const Verdict& verdict) {
  wire::Verdict out;
  out.collision_class(static_cast<std::uint8_t>(verdict.collision_class));
  out.delta_mm(wire_interval(verdict.delta_mm));
  out.gpd_mm(wire_interval(verdict.gpd_mm));
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
  out.separation_about_mm(triple(verdict.separation_about_W));
  out.separation_of_b(verdict.separation_of_b);
  out.separation_way(static_cast<std::uint8_t>(verdict.separation_way));
  out.separation_path(static_cast<std::uint8_t>(verdict.separation_path));
  out.separation_blocker(verdict.separation_blocker.value);
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
  Door door("verdict");
  door.need(in.collision_class() <= static_cast<std::uint8_t>(CollisionClass::kReal), "class");
  door.interval(in.delta_mm(), "delta_mm");
  door.interval(in.gpd_mm(), "gpd_mm");
  door.number(in.fake_below_mm(), "fake_below_mm");
  door.number(in.real_above_mm(), "real_above_mm");
  door.number(in.margin_mm(), "margin_mm");
  door.need(in.probability() == kProbabilityUnknown ||
                (in.probability() >= 0.0 && in.probability() <= 1.0),
            "probability");
  door.finite(in.travel_mm(), "travel_mm");
  door.finite(in.normal_travel_mm(), "normal_travel_mm");
  door.position(in.point_mm(), "point_mm");
  door.vector(in.normal(), "normal");
  door.count(in.area_mm2(), "area_mm2");
  door.position(in.witness_mm(), "witness_mm");
  door.position(in.separation_translation_mm(), "separation_translation_mm");
  door.vector(in.separation_rotation_rad(), "separation_rotation_rad");
  door.position(in.separation_about_mm(), "separation_about_mm");
  door.need(in.separation_way() <= static_cast<std::uint8_t>(SeparationWay::kStraight) &&
                in.separation_path() <= static_cast<std::uint8_t>(SeparationPath::kBlocked),
            "separation");
  door.need(in.shape_a() <= kShapes && in.shape_b() <= kShapes, "shape");
  door.need(in.grade() <= static_cast<std::uint8_t>(DeviationGrade::kNominal), "grade");
  door.name(in.face_a(), "face_a");
  door.name(in.face_b(), "face_b");
  door.text(in.explanation(), "explanation");
  if (!door.open()) return door.refusal();
  Verdict verdict;
  verdict.collision_class = static_cast<CollisionClass>(in.collision_class());
  verdict.delta_mm = interval_of(in.delta_mm());
  verdict.gpd_mm = interval_of(in.gpd_mm());
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
  verdict.separation_about_W = vec3(in.separation_about_mm());
  verdict.separation_of_b = in.separation_of_b();
  verdict.separation_way = static_cast<SeparationWay>(in.separation_way());
  verdict.separation_path = static_cast<SeparationPath>(in.separation_path());
  verdict.separation_blocker = PartId{in.separation_blocker()};
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
  out.pose(wire_pose(pose.X_WP));
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

namespace {

wire::Review to_wire(const Review& review) {
  wire::Review out;
  out.status(static_cast<std::uint8_t>(review.status));
  out.user(review.user.value);
  out.tick(review.tick);
  out.comment(clip(review.comment, kMaxText_bytes));
  return out;
}

Result<Review> from_wire(const wire::Review& in) {
  Door door("review");
  door.need(in.status() < kReviewStatusCount, "status");
  door.text(in.comment(), "comment");
  if (!door.open()) return door.refusal();
  return Review{static_cast<ReviewStatus>(in.status()), in.comment(), UserId{in.user()}, in.tick()};
}

}  // namespace

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
  out.worst_delta_mm(wire_interval(event.worst_delta_mm));
  out.verdict(to_wire(event.verdict));
  out.cause(static_cast<std::uint8_t>(event.cause));
  out.review(to_wire(event.review));
  out.approval_lost(event.approval_lost);
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
  door.interval(in.worst_delta_mm(), "worst_delta_mm");
  door.need(in.cause() < kDecisionKindCount, "cause");
  if (!door.open()) return door.refusal();
  Result<Verdict> verdict = from_wire(in.verdict());
  if (!verdict) return verdict.error();
  Result<Review> review = from_wire(in.review());
  if (!review) return review.error();
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
  event.worst_delta_mm = interval_of(in.worst_delta_mm());
  event.cause = static_cast<Decision::Kind>(in.cause());
  event.review = std::move(*review);
  event.approval_lost = in.approval_lost();
  return event;
}

std::vector<ClashEvent> events_from_wire(const wire::EventBatch& batch, std::uint64_t& malformed) {
  std::vector<ClashEvent> events;
  if (batch.events().size() > kMaxSequence) {
    ++malformed;
    return events;
  }
  for (const wire::ClashEvent& entry : batch.events()) {
    Result<ClashEvent> event = from_wire(entry);
    if (event) {
      events.push_back(std::move(*event));
    } else {
      ++malformed;
    }
  }
  return events;
}

wire::PartInfo to_wire(const PartInfo& part) {
  wire::PartInfo out;
  out.part(part.part.value);
  out.holder(part.holder.value);
  out.moving(part.moving);
  out.name(clip(part.name, kMaxName_bytes));
  out.mesh_hash(clip(part.mesh_hash, kMaxName_bytes));
  out.pose(wire_pose(part.X_WP));
  out.reference_mm(triple(part.reference_P));
  out.radius_mm(part.radius_mm);
  return out;
}

wire::PartNote to_wire(const PartNote& note) {
  wire::PartNote out;
  out.part(note.part.value);
  out.text(clip(note.text, kMaxText_bytes));
  return out;
}

Result<PartNote> from_wire(const wire::PartNote& in) {
  Door door("note of a part");
  door.need(in.part() != 0, "part");
  door.text(in.text(), "text");
  if (!door.open()) return door.refusal();
  return PartNote{PartId{in.part()}, in.text()};
}

wire::Remark to_wire(const Remark& remark) {
  wire::Remark out;
  out.clash(remark.clash.value);
  out.user(remark.user.value);
  out.assignee(remark.assignee.value);
  out.status(static_cast<std::uint8_t>(remark.status));
  out.tick(remark.tick);
  out.text(clip(remark.text, kMaxText_bytes));
  return out;
}

Result<Remark> from_wire(const wire::Remark& in) {
  Door door("remark");
  door.need(in.clash() != 0, "clash");
  door.need(in.status() < kReviewStatusCount, "status");
  door.text(in.text(), "text");
  if (!door.open()) return door.refusal();
  return Remark{ClashId{in.clash()},
                UserId{in.user()},
                UserId{in.assignee()},
                static_cast<ReviewStatus>(in.status()),
                in.tick(),
                in.text()};
}

wire::UserInfo to_wire(const UserInfo& user) {
  wire::UserInfo out;
  out.user(user.user.value);
  out.present(user.present);
  out.role(static_cast<std::uint8_t>(user.role));
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
  if (Status read = read_all(in.notes(), snapshot.notes); !read) return read.error();
  if (Status read = read_all(in.remarks(), snapshot.remarks); !read) return read.error();
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
  for (const UnexaminedRow& row : pulse.unexamined) {
    wire::UnexaminedPair& pair = out.unexamined().emplace_back();
    pair.part_a(row.a.value);
    pair.part_b(row.b.value);
    pair.why(static_cast<std::uint8_t>(row.why));
    pair.ticks(row.ticks);
  }
  out.unexamined_left_out(pulse.unexamined_left_out);
  return out;
}

Result<SessionPulse> from_wire(const wire::Pulse& in) {
  Door door("pulse");
  door.count(in.tick_p50_us(), "tick_p50_us");
  door.count(in.tick_p99_us(), "tick_p99_us");
  door.count(in.tick_max_us(), "tick_max_us");
  door.count(in.lateness_p99_us(), "lateness_p99_us");
  door.need(in.unexamined().size() <= kMostUnexaminedRows, "unexamined");
  for (const wire::UnexaminedPair& pair : in.unexamined())
    door.need(pair.part_a() != 0 && pair.part_a() < pair.part_b() && pair.why() < kUnexaminedCount,
              "unexamined");
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
  for (const wire::UnexaminedPair& pair : in.unexamined())
    pulse.unexamined.push_back({PartId{pair.part_a()}, PartId{pair.part_b()},
                                static_cast<Unexamined>(pair.why()), pair.ticks()});
  pulse.unexamined_left_out = in.unexamined_left_out();
  return pulse;
}

// ---- what constraints can name

wire::Feature to_wire(const FeatureInfo& feature) {
  wire::Feature out;
  out.origin(static_cast<std::uint8_t>(feature.origin));
  out.kind(static_cast<std::uint8_t>(feature.kind));
  out.inward(feature.inward);
  out.point_mm(triple(feature.point_P));
  out.axis(triple(feature.axis_P));
  out.radius_mm(feature.radius_mm);
  out.tube_radius_mm(feature.tube_radius_mm);
  out.half_angle_rad(feature.half_angle_rad);
  out.along_mm(wire_interval(feature.along_mm));
  out.middle_mm(triple(feature.middle_P));
  out.name(clip(feature.name, kMaxName_bytes));
  return out;
}

Result<FeatureInfo> from_wire(const wire::Feature& in) {
  Door door("feature");
  door.need(in.origin() != 0 && in.origin() < kFeatureOriginCount, "origin");
  door.need(in.kind() != 0 && in.kind() < kSurfaceKindCount, "kind");
  door.position(in.point_mm(), "point_mm");
  door.need(std::abs(vec3(in.axis()).norm() - 1.0) <= kUnitNormAllowance, "axis");
  for (const double radius_mm : {in.radius_mm(), in.tube_radius_mm()})
    door.need(radius_mm >= 0.0 && radius_mm <= kMaxCoordinate_mm, "radius_mm");
  door.need(in.half_angle_rad() >= 0.0 && in.half_angle_rad() <= 0.5 * std::numbers::pi,
            "half_angle_rad");
  for (const double along_mm : {in.along_mm().lo(), in.along_mm().hi()})
    door.need(std::abs(along_mm) <= kMaxCoordinate_mm, "along_mm");
  door.interval(in.along_mm(), "along_mm");
  door.position(in.middle_mm(), "middle_mm");
  door.need(!in.name().empty(), "name");
  door.name(in.name(), "name");
  if (!door.open()) return door.refusal();
  FeatureInfo feature;
  feature.name = in.name();
  feature.origin = static_cast<FeatureOrigin>(in.origin());
  feature.kind = static_cast<SurfaceKind>(in.kind());
  feature.inward = in.inward();
  feature.point_P = vec3(in.point_mm());
  feature.axis_P = vec3(in.axis());
  feature.radius_mm = in.radius_mm();
  feature.tube_radius_mm = in.tube_radius_mm();
  feature.half_angle_rad = in.half_angle_rad();
  feature.along_mm = interval_of(in.along_mm());
  feature.middle_P = vec3(in.middle_mm());
  return feature;
}

Result<FeatureSet> from_wire(const wire::FeatureSet& in) {
  Door door("feature set");
  door.sequence(in.parts(), "parts");
  for (const std::uint32_t part : in.parts()) door.need(part != 0, "parts");
  if (!door.open()) return door.refusal();
  FeatureSet set;
  for (const std::uint32_t part : in.parts()) set.parts.push_back(PartId{part});
  if (Status read = read_all(in.features(), set.features); !read) return read.error();
  return set;
}

Result<FeatureTable> from_wire(const wire::Features& in) {
  FeatureTable table;
  table.meshes_waiting = in.meshes_waiting();
  table.meshes_too_large = in.meshes_too_large();
  table.left_out = in.left_out();
  if (Status read = read_all(in.sets(), table.sets); !read) return read.error();
  return table;
}

}  // namespace mortise
