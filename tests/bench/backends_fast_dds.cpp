// The participant of this project, as it is.
#include "idl/participant.h"
#include "idl/wire_types.h"
#include "tests/bench/backends_peer.h"

namespace mortise::bench {
namespace {

constexpr std::uint32_t kUser = 1;

/// Hands each sample to an action.
template <class Sample>
class Listener final : public dds::DataReaderListener {
 public:
  std::function<void(const Sample&)> heard;
  std::function<void(bool)> alive;
  void on_data_available(dds::DataReader* reader) override {
    take_all<Sample>(*reader, [&](const Sample& sample, const auto&) {
      if (heard) heard(sample);
    });
  }
  void on_liveliness_changed(dds::DataReader*,
                             const dds::LivelinessChangedStatus& status) override {
    if (alive && status.alive_count_change != 0) alive(status.alive_count_change > 0);
  }
};

class FastPeer final : public Peer {
 public:
  explicit FastPeer(PeerHears hears) : hears_(std::move(hears)) {}
  ~FastPeer() override { participant_.reset(); }  // before its listeners

  bool open(const PeerOptions& options) {
    DdsOptions where;
    where.domain = options.domain;
    where.liveliness_lease_s = options.lease_s;
    where.keys = options.keys;
    auto opened = Participant::open(
        where, options.is_server ? Participant::Side::kServer : Participant::Side::kClient,
        nullptr);
    if (!opened) return false;
    participant_ = std::move(*opened);
    Status status = ok();
    if (options.is_server) {
      if (hears_.increment)
        on_increment_.heard = [this](const wire::IncrementBatch& batch) {
          hears_.increment(batch.fresh_from());
        };
      on_presence_.alive = hears_.presence;
      participant_->open_reader<wire::IncrementBatchPubSubType>(Topic::kIncrement, &on_increment_,
                                                                increments_in_, status);
      participant_->open_reader<wire::PresencePubSubType>(Topic::kPresence, &on_presence_,
                                                          presence_in_, status);
      participant_->open_writer<wire::PoseBatchPubSubType>(Topic::kPose, poses_, status);
      participant_->open_writer<wire::MeshChunkPubSubType>(Topic::kMesh, meshes_, status);
      return bool(status);
    }
    if (hears_.acknowledged)
      on_pose_.heard = [this](const wire::PoseBatch& batch) {
        for (const wire::Ack& ack : batch.acks()) hears_.acknowledged(ack.seq());
      };
    if (hears_.mesh)
      on_mesh_.heard = [this](const wire::MeshChunk& piece) { hears_.mesh(piece.bytes().size()); };
    participant_->open_writer<wire::IncrementBatchPubSubType>(Topic::kIncrement, increments_,
                                                              status);
    participant_->open_writer<wire::PresencePubSubType>(Topic::kPresence, presence_, status);
    participant_->open_reader<wire::PoseBatchPubSubType>(Topic::kPose, &on_pose_, poses_in_,
                                                         status);
    if (options.meshes)
      participant_->open_reader<wire::MeshChunkPubSubType>(Topic::kMesh, &on_mesh_, meshes_in_,
                                                           status);
    return bool(status);
  }

  bool say_increment(std::uint64_t seq) override {
    wire::IncrementBatch batch;
    batch.user(kUser);
    batch.kept_from(seq);
    batch.fresh_from(seq);
    batch.increments().resize(1);
    batch.increments()[0].seq(seq);
    return increments_->write(&batch);
  }
  bool say_present() override {
    wire::Presence present;
    present.user(kUser);
    present.beat(++beat_);
    return presence_->write(&present);
  }
  bool say_acknowledged(std::uint64_t seq) override {
    wire::PoseBatch batch;
    batch.count(1);
    batch.serial(++serial_);
    batch.acks().resize(1);
    batch.acks()[0].user(kUser);
    batch.acks()[0].seq(seq);
    return poses_->write(&batch);
  }
  bool say_mesh(std::uint32_t chunk, std::span<const std::uint8_t> bytes) override {
    wire::MeshChunk piece;
    piece.mesh(1);
    piece.chunk(chunk);
    piece.bytes().assign(bytes.begin(), bytes.end());
    return meshes_->write(&piece);
  }
  bool has_met() const override {
    dds::SubscriptionMatchedStatus heard;
    return matched(increments_) &&
           poses_in_->get_subscription_matched_status(heard) ==
               eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK &&
           heard.current_count > 0;
  }

 private:
  PeerHears hears_;
  Listener<wire::IncrementBatch> on_increment_;
  Listener<wire::Presence> on_presence_;
  Listener<wire::PoseBatch> on_pose_;
  Listener<wire::MeshChunk> on_mesh_;
  std::unique_ptr<Participant> participant_;
  dds::DataWriter *increments_ = nullptr, *presence_ = nullptr, *poses_ = nullptr,
                  *meshes_ = nullptr;
  dds::DataReader *increments_in_ = nullptr, *presence_in_ = nullptr, *poses_in_ = nullptr,
                  *meshes_in_ = nullptr;
  std::uint64_t beat_ = 0, serial_ = 0;
};

}  // namespace

std::unique_ptr<Peer> open_fast_dds(const PeerOptions& options, PeerHears hears) {
  auto peer = std::make_unique<FastPeer>(std::move(hears));
  return peer->open(options) ? std::move(peer) : nullptr;
}

}  // namespace mortise::bench
