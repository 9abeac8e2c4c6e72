#include <cmath>
#include <cstring>

#include "common/base/check.h"
#include "idl/chunks.h"
#include "idl/datagram_guard.h"
#include "server/tick_bytes.h"
#include "tests/fuzz/targets.h"
#include "tests/unit/idl/samples.h"

namespace mortise::test {
namespace {

using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
using Bytes = std::span<const std::uint8_t>;

template <class Type, class Sample>
bool read(Bytes bytes, Sample& sample) {
  static const auto refused = std::make_shared<std::atomic<std::uint64_t>>(0);
  static SafeType<Type> type(refused);
  Payload payload(static_cast<std::uint32_t>(bytes.size()) + 1);
  std::memcpy(payload.data, bytes.data(), bytes.size());
  payload.length = static_cast<std::uint32_t>(bytes.size());
  return type.deserialize(&payload, &sample);
}

template <class Type, class Sample>
std::string written(char pick, Sample sample) {
  Type type;
  Payload payload(65536);
  MORTISE_CHECK(type.serialize(&sample, &payload), "a sample of ours is not written");
  return pick + std::string(reinterpret_cast<const char*>(payload.data), payload.length);
}

bool increments(Bytes bytes) {
  wire::IncrementBatch sample;
  if (!read<wire::IncrementBatchPubSubType>(bytes, sample)) return false;
  const auto batch = from_wire(sample);
  if (!batch) return false;
  std::uint64_t last = 0;
  bool any = false;
  for (const ReceivedIncrement& r : *batch) {
    MORTISE_CHECK(r.increment.user && (r.increment.seq > last || last == 0), "order");
    MORTISE_CHECK(r.increment.translation_mm.allFinite() && r.increment.rotation_rad.allFinite(),
                  "what is not finite must not come through the door");
    last = r.increment.seq;
    any |= r.at_door == Refusal::kNone;
  }
  return any;
}

bool requests(Bytes bytes) {
  wire::Request sample;
  if (!read<wire::RequestPubSubType>(bytes, sample)) return false;
  const auto request = from_wire(sample);
  if (!request) return false;
  MORTISE_CHECK(request->kind != Request::Kind::kUnknown, "a request of no kind");
  MORTISE_CHECK(text_ok(request->name, kMaxName_bytes), "a name that no log should hold");
  return true;
}

bool answers(Bytes bytes) {
  wire::Answers sample;
  return read<wire::AnswersPubSubType>(bytes, sample) && bool(from_wire(sample));
}

bool poses(Bytes bytes) {
  wire::PoseBatch sample;
  if (!read<wire::PoseBatchPubSubType>(bytes, sample)) return false;
  const auto batch = from_wire(sample);
  if (!batch) return false;
  for (const PartPose& pose : batch->parts) {
    MORTISE_CHECK(pose.part && pose.X_WP.p.allFinite(), "pose");
  }
  static ChunkCollector<wire::PoseBatch> collector;
  (void)collector.add(sample);
  return true;
}

bool events(Bytes bytes) {
  wire::EventBatch sample;
  if (!read<wire::EventBatchPubSubType>(bytes, sample)) return false;
  bool any = false;
  for (const wire::ClashEvent& entry : sample.events()) {
    const auto event = from_wire(entry);
    if (!event) continue;
    any = true;
    MORTISE_CHECK(event->clash && event->part_a && event->part_b, "ids");
    MORTISE_CHECK(bool(from_wire(to_wire(*event))), "what came in must go out and in again");
  }
  return any;
}

bool snapshots(Bytes bytes) {
  wire::Snapshot sample;
  if (!read<wire::SnapshotPubSubType>(bytes, sample)) return false;
  const auto snapshot = from_wire(sample);
  if (!snapshot) return false;
  for (const PartInfo& part : snapshot->parts) {
    MORTISE_CHECK(part.part && std::isfinite(part.radius_mm), "part");
  }
  return true;
}

bool meshes(Bytes bytes) {
  wire::MeshChunk sample;
  if (!read<wire::MeshChunkPubSubType>(bytes, sample)) return false;
  MeshCollector collector;
  return collector.add(sample).has_value();
}

bool features(Bytes bytes) {
  wire::Features sample;
  if (!read<wire::FeaturesPubSubType>(bytes, sample)) return false;
  const auto table = from_wire(sample);
  if (!table) return false;
  for (const FeatureSet& set : table->sets) {
    for (const PartId part : set.parts) MORTISE_CHECK(part, "a feature of no part");
    for (const FeatureInfo& feature : set.features) {
      MORTISE_CHECK(feature.point_P.allFinite() && feature.along_mm.lo <= feature.along_mm.hi,
                    "feature");
      MORTISE_CHECK(bool(from_wire(to_wire(feature))), "what came in must go out and in again");
    }
  }
  return true;
}

bool pulses(Bytes bytes) {
  wire::Pulse sample;
  return read<wire::PulsePubSubType>(bytes, sample) && bool(from_wire(sample));
}

// What a second server is told of a tick: its bytes are read by the room that wrote them.
bool told_ticks(Bytes bytes) {
  FollowedTick tick;
  if (!decode(std::as_bytes(bytes), tick)) return false;
  FollowedTick again;
  MORTISE_CHECK(decode(encode(tick), again), "what came in must go out and in again");
  MORTISE_CHECK(again.tick == tick.tick && again.state_hash == tick.state_hash &&
                    again.decisions.size() == tick.decisions.size() &&
                    again.increments.size() == tick.increments.size() &&
                    again.seats.size() == tick.seats.size(),
                "and be the same");
  return true;
}

bool server_ticks(Bytes bytes) {
  wire::ServerTick sample;
  return read<wire::ServerTickPubSubType>(bytes, sample) && told_ticks(Bytes(sample.bytes()));
}

bool takings(Bytes bytes) {
  wire::ServerTaken sample;
  return read<wire::ServerTakenPubSubType>(bytes, sample);
}

bool presences(Bytes bytes) {
  wire::Presence sample;
  return read<wire::PresencePubSubType>(bytes, sample);
}

ToldTick some_told_tick() {
  FollowedTick tick;
  tick.tick = 7;
  tick.decisions.push_back({Decision::Kind::kJoin, UserId{1}, {}, "anna", Role::kDesigner});
  tick.decisions.push_back({Decision::Kind::kReview, UserId{1}, PartId{2}, {}, {}, some_details()});
  tick.increments.push_back(some_increment());
  tick.has_seats = true;
  tick.seats.push_back({UserId{1}, "client", 5});
  return {tick.tick, encode(tick)};
}

std::string as_text(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

bool fuzz_wire(std::span<const std::uint8_t> input) {
  MORTISE_CHECK(admissible_length(std::as_bytes(input)) <= input.size(), "guard");
  if (input.empty()) return false;
  constexpr bool (*kDoors[])(Bytes) = {increments, requests,  answers,  poses,    events,
                                       snapshots,  meshes,    pulses,   features, server_ticks,
                                       takings,    presences, told_ticks};
  return kDoors[input[0] % std::size(kDoors)](input.subspan(1));
}

std::vector<std::string> wire_seeds() {
  std::mt19937_64 random(5);
  IncrementBatch batch{3, 5, {}};
  for (std::uint64_t seq = 3; seq < 6; ++seq) {
    batch.increments.push_back({some_increment(), 123});
    batch.increments.back().increment.seq = seq;
  }
  PoseBatch poses;
  for (int i = 0; i < 3; ++i) poses.parts.push_back(some_pose(random));
  poses.acks.push_back({UserId{1}, 7, 8});
  const JoinReply join{"client", 1, UserId{1}, Refusal::kNone, ""};
  const Reply reply{UserId{1}, PartId{2}, 3, Refusal::kHeldByOther, UserId{2}, "held by ben"};
  const RefusedIncrement refused{UserId{2}, PartId{3}, 6, Refusal::kNotHolder};
  FeatureTable features;
  features.sets.push_back({{PartId{1}, PartId{2}}, {some_feature()}});
  wire::ServerTaken taken;
  taken.tick(7);
  wire::Presence present;
  present.user(1);
  const std::string mesh = "sixteen bytes or so of a mesh";
  return {
      written<wire::IncrementBatchPubSubType>('\0', to_wire(batch)),
      written<wire::RequestPubSubType>('\1', to_wire(some_join())),
      written<wire::AnswersPubSubType>(
          '\2', to_wire(std::span(&join, 1), std::span(&reply, 1), std::span(&refused, 1))),
      written<wire::PoseBatchPubSubType>('\3', cut(poses, 9).front()),
      written<wire::EventBatchPubSubType>('\4', some_event_batch()),
      written<wire::SnapshotPubSubType>('\5', some_snapshot_chunk()),
      written<wire::MeshChunkPubSubType>(
          '\6', cut_mesh("0123456789abcdef", std::as_bytes(std::span(mesh))).front()),
      written<wire::PulsePubSubType>('\7', to_wire(SessionPulse{}, 4)),
      written<wire::FeaturesPubSubType>('\10', cut(features, 3).front()),
      written<wire::ServerTickPubSubType>('\11', cut(some_told_tick(), 4).front()),
      written<wire::ServerTakenPubSubType>('\12', taken),
      written<wire::PresencePubSubType>('\13', present),
      '\14' + as_text(some_told_tick().bytes),
  };
}

}  // namespace mortise::test
