// A sample of each topic as the programs of a version write it, every member with a value of its
// own: tests/golden/wire/VERSION/TOPIC.cdr. This build must read these values from them. Files of a
// version are never written again; a new version adds a folder and a case, with the members that it
// has appended: MORTISE_RECORD_WIRE_OF=VERSION writes them.
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "idl/safe_type.h"
#include "idl/topics.h"
#include "idl/wire_types.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

/// A number after the other: no two members of a sample are the same.
class Numbers {
 public:
  operator std::uint32_t() { return ++last_; }
  std::uint8_t octet() { return static_cast<std::uint8_t>(++last_); }
  std::uint64_t wide() { return (std::uint64_t{1} << 40U) + ++last_; }
  std::int64_t before() { return -static_cast<std::int64_t>(wide()); }
  double real() { return ++last_ + 0.25; }
  std::string text() { return "text " + std::to_string(++last_); }
  wire::Triple triple() { return {real(), real(), real()}; }
  wire::Quadruple quadruple() { return {real(), real(), real(), real()}; }
  wire::Interval interval() {
    wire::Interval made;
    made.lo(real());
    made.hi(real());
    return made;
  }
  wire::Pose pose() {
    wire::Pose made;
    made.q(quadruple());
    made.p_mm(triple());
    return made;
  }
  wire::FeatureOf feature_of() {
    wire::FeatureOf made;
    made.part(*this);
    made.feature(text());
    return made;
  }
  wire::Constraint constraint() {
    wire::Constraint made;
    made.kind(octet());
    made.held(feature_of());
    made.other(feature_of());
    made.distance_mm(real());
    made.snap(true);
    return made;
  }
  wire::Review review() {
    wire::Review made;
    made.status(octet());
    made.user(*this);
    made.tick(wide());
    made.comment(text());
    return made;
  }
  wire::Details details() {
    wire::Details made;
    made.parts({*this, *this});
    made.pair().resize(1);
    made.pair()[0].feature(text());
    made.pair()[0].other(feature_of());
    made.review().resize(1);
    made.review()[0].clash(*this);
    made.review()[0].status(octet());
    made.constraint({constraint()});
    made.constraint_id(*this);
    made.other_user(*this);
    made.text(text());
    made.edit().resize(1);
    wire::PartEdit& edit = made.edit()[0];
    edit.name(text());
    edit.mesh_hash(text());
    edit.pose(pose());
    edit.moving(true);
    edit.quantum_mm(real());
    return made;
  }
  wire::Decision decision() {
    wire::Decision made;
    made.kind(octet());
    made.user(*this);
    made.part(*this);
    made.role(octet());
    made.user_name(text());
    made.details(details());
    return made;
  }
  wire::Verdict verdict() {
    wire::Verdict made;
    made.collision_class(octet());
    made.delta_mm(interval());
    made.gpd_mm(interval());
    made.fake_below_mm(real());
    made.real_above_mm(real());
    made.margin_mm(real());
    made.probability(real());
    made.travel_mm(real());
    made.normal_travel_mm(real());
    made.point_mm(triple());
    made.normal(triple());
    made.area_mm2(real());
    made.has_witness(true);
    made.witness_mm(triple());
    made.separation_translation_mm(triple());
    made.separation_rotation_rad(triple());
    made.separation_about_mm(triple());
    made.separation_of_b(false);
    made.separation_way(octet());
    made.separation_path(octet());
    made.separation_blocker(*this);
    made.shape_a(octet());
    made.shape_b(octet());
    made.grade(octet());
    made.face_a(text());
    made.face_b(text());
    made.explanation(text());
    return made;
  }
  wire::ClashEvent clash() {
    wire::ClashEvent made;
    made.kind(octet());
    made.seq(wide());
    made.tick(wide());
    made.clash(*this);
    made.part_a(*this);
    made.part_b(*this);
    made.user(*this);
    made.t_contact(real());
    made.t_potential(real());
    made.t_real(real());
    made.begin_tick(wide());
    made.worst_class(octet());
    made.worst_delta_mm(interval());
    made.verdict(verdict());
    made.cause(octet());
    made.review(review());
    made.approval_lost(true);
    return made;
  }

 private:
  std::uint32_t last_ = 0;
};

// ---- as 0.2.0 says it: members that were appended later are not set here

wire::IncrementBatch increments_020() {
  Numbers n;
  wire::IncrementBatch made;
  made.user(n);
  made.kept_from(n.wide());
  made.fresh_from(n.wide());
  made.increments().resize(2);
  for (wire::Increment& one : made.increments()) {
    one.part(n);
    one.seq(n.wide());
    one.sent_ns(n.before());
    one.translation_mm(n.triple());
    one.rotation_rad(n.triple());
  }
  return made;
}

wire::Request request_020() {
  Numbers n;
  wire::Request made;
  made.join().resize(1);
  made.join()[0].nonce(n.wide());
  made.join()[0].name(n.text());
  made.join()[0].role(n.text());
  made.leave().resize(1);
  made.leave()[0].user(n);
  made.command().resize(1);
  wire::Command& command = made.command()[0];
  command.kind(n.octet());
  command.user(n);
  command.part(n);
  command.seq(n.wide());
  command.after(n.wide());
  command.details(n.details());
  made.snapshot(true);
  made.upload().resize(1);
  wire::UploadPiece& piece = made.upload()[0];
  piece.user(n);
  piece.upload(n.wide());
  piece.name(n.text());
  piece.unit_mm(n.real());
  piece.hash(n.text());
  piece.length(n.wide());
  piece.offset(n.wide());
  piece.bytes({n.octet(), n.octet(), n.octet()});
  return made;
}

wire::Presence presence_020() {
  Numbers n;
  wire::Presence made;
  made.user(n);
  made.beat(n.wide());
  return made;
}

wire::Answers answers_020() {
  Numbers n;
  wire::Answers made;
  made.joins().resize(1);
  wire::JoinReply& join = made.joins()[0];
  join.client(n.text());
  join.nonce(n.wide());
  join.user(n);
  join.refusal(n.octet());
  join.text(n.text());
  made.replies().resize(1);
  wire::Reply& reply = made.replies()[0];
  reply.user(n);
  reply.part(n);
  reply.seq(n.wide());
  reply.refusal(n.octet());
  reply.holder(n);
  reply.text(n.text());
  made.refused().resize(1);
  wire::RefusedIncrement& refused = made.refused()[0];
  refused.user(n);
  refused.part(n);
  refused.seq(n.wide());
  refused.reason(n.octet());
  made.decisions({n.decision(), n.decision()});
  made.standing().resize(1);
  made.standing()[0].tick(n.wide());
  made.standing()[0].holds(true);
  made.standing()[0].decision(n.decision());
  made.uploads().resize(1);
  wire::UploadState& upload = made.uploads()[0];
  upload.user(n);
  upload.upload(n.wide());
  upload.received(n.wide());
  upload.ready(true);
  upload.mesh_hash(n.text());
  upload.refusal(n.octet());
  upload.text(n.text());
  return made;
}

wire::PoseBatch poses_020() {
  Numbers n;
  wire::PoseBatch made;
  made.chunk(n);
  made.count(n);
  made.serial(n.wide());
  made.tick(n.wide());
  made.event_seq(n.wide());
  made.sent_ns(n.before());
  made.parts().resize(2);
  for (wire::PartPose& part : made.parts()) {
    part.part(n);
    part.holder(n);
    part.pose(n.pose());
  }
  made.acks().resize(2);
  for (wire::Ack& ack : made.acks()) {
    ack.user(n);
    ack.seq(n.wide());
    ack.sent_ns(n.before());
  }
  return made;
}

wire::EventBatch events_020() {
  Numbers n;
  wire::EventBatch made;
  made.events({n.clash(), n.clash()});
  return made;
}

wire::Snapshot snapshot_020() {
  Numbers n;
  wire::Snapshot made;
  made.chunk(n);
  made.count(n);
  made.serial(n.wide());
  made.tick(n.wide());
  made.event_seq(n.wide());
  made.tick_rate_hz(n.real());
  made.session(n.text());
  made.policy(n.text());
  made.parts().resize(1);
  wire::PartInfo& part = made.parts()[0];
  part.part(n);
  part.holder(n);
  part.moving(true);
  part.name(n.text());
  part.mesh_hash(n.text());
  part.pose(n.pose());
  part.reference_mm(n.triple());
  part.radius_mm(n.real());
  made.users().resize(1);
  made.users()[0].user(n);
  made.users()[0].present(true);
  made.users()[0].role(n.octet());
  made.users()[0].name(n.text());
  made.open_clashes({n.clash()});
  made.standing({n.decision()});
  made.notes().resize(1);
  made.notes()[0].part(n);
  made.notes()[0].text(n.text());
  made.remarks().resize(1);
  wire::Remark& remark = made.remarks()[0];
  remark.clash(n);
  remark.user(n);
  remark.assignee(n);
  remark.status(n.octet());
  remark.tick(n.wide());
  remark.text(n.text());
  return made;
}

wire::MeshChunk mesh_020() {
  Numbers n;
  wire::MeshChunk made;
  made.mesh(n.wide());
  made.chunk(n);
  made.count(n);
  made.mesh_hash(n.text());
  made.bytes({n.octet(), n.octet(), n.octet()});
  return made;
}

wire::Features features_020() {
  Numbers n;
  wire::Features made;
  made.chunk(n);
  made.count(n);
  made.serial(n.wide());
  made.meshes_waiting(n);
  made.meshes_too_large(n);
  made.left_out(n);
  made.sets().resize(1);
  made.sets()[0].parts({n, n});
  made.sets()[0].features().resize(1);
  wire::Feature& feature = made.sets()[0].features()[0];
  feature.origin(n.octet());
  feature.kind(n.octet());
  feature.inward(true);
  feature.point_mm(n.triple());
  feature.axis(n.triple());
  feature.radius_mm(n.real());
  feature.tube_radius_mm(n.real());
  feature.half_angle_rad(n.real());
  feature.along_mm(n.interval());
  feature.middle_mm(n.triple());
  feature.name(n.text());
  return made;
}

wire::Pulse pulse_020() {
  Numbers n;
  wire::Pulse made;
  made.tick(n.wide());
  made.clashes_open({n.wide(), n.wide(), n.wide(), n.wide()});
  made.clashes_total({n.wide(), n.wide(), n.wide(), n.wide()});
  made.tick_p50_us(n.real());
  made.tick_p99_us(n.real());
  made.tick_max_us(n.real());
  made.lateness_p99_us(n.real());
  made.missed_deadlines(n.wide());
  made.refused(n.wide());
  made.not_examined(n.wide());
  made.users(n);
  made.pose_serial(n.wide());
  made.draining(true);
  made.unexamined().resize(1);
  wire::UnexaminedPair& pair = made.unexamined()[0];
  pair.part_a(n);
  pair.part_b(n);
  pair.why(n.octet());
  pair.ticks(n);
  made.unexamined_left_out(n.wide());
  return made;
}

wire::ServerTick server_tick_020() {
  Numbers n;
  wire::ServerTick made;
  made.tick(n.wide());
  made.term(n.wide());
  made.chunk(n);
  made.count(n);
  made.bytes({n.octet(), n.octet(), n.octet()});
  made.follower(n.text());
  return made;
}

wire::ServerTaken server_taken_020() {
  Numbers n;
  wire::ServerTaken made;
  made.tick(n.wide());
  made.term(n.wide());
  made.computed(n.wide());
  return made;
}

// ---- writing and reading

using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;

template <class Type, class Sample>
std::string written(Sample sample) {
  Type type;
  Payload payload(65536);
  EXPECT_TRUE(type.serialize(&sample, &payload));
  return {reinterpret_cast<const char*>(payload.data), payload.length};
}

template <class Type, class Sample>
void is_read(const fs::path& folder, Topic topic, const Sample& sample) {
  const std::string name = row_of(topic).topic;
  SCOPED_TRACE(name);
  const fs::path file = folder / (name + ".cdr");
  const char* version = std::getenv("MORTISE_RECORD_WIRE_OF");
  if (version != nullptr && folder.filename() == version) {
    ASSERT_FALSE(fs::exists(file)) << "is never written again";
    fs::create_directories(folder);
    std::ofstream(file, std::ios::binary) << written<Type>(sample);
  }
  std::ifstream in(file, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  ASSERT_FALSE(bytes.empty()) << file;
  Payload payload(static_cast<std::uint32_t>(bytes.size()));
  std::memcpy(payload.data, bytes.data(), bytes.size());
  payload.length = payload.max_size;
  const auto refused = std::make_shared<std::atomic<std::uint64_t>>(0);
  SafeType<Type> type(refused);
  Sample read;
  ASSERT_TRUE(type.deserialize(&payload, &read));
  EXPECT_TRUE(read == sample) << "another value is read than was written";
  EXPECT_TRUE(written<Type>(sample).starts_with(bytes))
      << "a program of that version would read another value than this one writes";
}

TEST(WireOfVersion, ValuesOf020AreReadAsTheyWereWritten) {
  const fs::path folder = fs::path(MORTISE_SOURCE_DIR) / "tests/golden/wire/0.2.0";
  is_read<wire::IncrementBatchPubSubType>(folder, Topic::kIncrement, increments_020());
  is_read<wire::RequestPubSubType>(folder, Topic::kRequest, request_020());
  is_read<wire::PresencePubSubType>(folder, Topic::kPresence, presence_020());
  is_read<wire::AnswersPubSubType>(folder, Topic::kAnswers, answers_020());
  is_read<wire::PoseBatchPubSubType>(folder, Topic::kPose, poses_020());
  is_read<wire::PoseBatchPubSubType>(folder, Topic::kKeyframe, poses_020());
  is_read<wire::EventBatchPubSubType>(folder, Topic::kEvent, events_020());
  is_read<wire::SnapshotPubSubType>(folder, Topic::kSnapshot, snapshot_020());
  is_read<wire::MeshChunkPubSubType>(folder, Topic::kMesh, mesh_020());
  is_read<wire::FeaturesPubSubType>(folder, Topic::kFeatures, features_020());
  is_read<wire::PulsePubSubType>(folder, Topic::kPulse, pulse_020());
  is_read<wire::ServerTickPubSubType>(folder, Topic::kTick, server_tick_020());
  is_read<wire::ServerTakenPubSubType>(folder, Topic::kTaken, server_taken_020());
  const auto files = std::distance(fs::directory_iterator(folder), fs::directory_iterator());
  EXPECT_EQ(static_cast<std::size_t>(files), topic_table().size()) << "one of each topic";
}

}  // namespace
}  // namespace mortise
