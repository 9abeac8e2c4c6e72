#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "common/messages/channel.h"
#include "idl/chunks.h"
#include "idl/participant.h"
#include "idl/server_watch.h"

namespace mortise {

/// What a client hears from the server that leads: the readers of its topics, with what is cut in
/// chunks put together. What others say, or said before, is dropped.
class ClientReaders {
 public:
  /// Before any thread of Fast DDS calls; both must outlive this. `arrivals` rings when samples
  /// come.
  ClientReaders(ServerWatch& watch, Bell& arrivals) : watch_(watch), arrivals_(arrivals) {}
  void open(Participant& participant, const DdsOptions& options, Status& status);
  /// Last of all endpoints: once the server's answers are matched, everything else is declared.
  void open_answers(Participant& participant, Status& status);

  /// `own`: key of this client, whose joins are answered.
  void take(const ClientKey& own, ClientInput& input);

  ChannelCounters counters() const;

 private:
  template <class Sample, class Action>
  bool take_each(dds::DataReader& reader, Action action);
  template <class Sample, class Action>
  void take_each(Inlet& inlet, Action action) {
    if (inlet.take_come() && !take_each<Sample>(*inlet.reader, action)) inlet.come = true;
  }
  void begin_with_another_server();
  void take_answers(const ClientKey& own, ClientInput& input);
  void take_snapshots(ClientInput& input);
  void take_poses(ClientInput& input);
  void take_keyframes(ClientInput& input);
  void take_events(ClientInput& input);
  void take_pulses(ClientInput& input);
  void take_meshes(ClientInput& input);
  void take_features(ClientInput& input);
  void note_pose_serial(std::uint64_t serial, ClientInput& input);
  template <class Value, class Chunk, class Add>
  std::optional<Value> joined(const std::vector<Chunk>& chunks, Add add);

  ServerWatch& watch_;
  Bell& arrivals_;
  Participant* participant_ = nullptr;
  dds::DataReader* answers_ = nullptr;
  Inlet poses_{arrivals_}, keyframes_{arrivals_}, events_{arrivals_}, snapshots_{arrivals_},
      pulses_{arrivals_}, meshes_{arrivals_}, features_{arrivals_};
  ServerWatch::Prefix server_;  ///< who said what was taken last
  ChunkCollector<wire::Snapshot> snapshot_collector_;
  ChunkCollector<wire::PoseBatch> keyframe_collector_;
  MeshCollector mesh_collector_;
  ChunkCollector<wire::Features> feature_collector_;
  std::uint64_t pose_serial_ = 0;
  ChannelCounters counters_;
};

}  // namespace mortise
