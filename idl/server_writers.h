#pragma once
#include <atomic>
#include <cstdint>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "common/messages/channel.h"
#include "idl/convert.h"
#include "idl/participant.h"
#include "idl/snapshot_sayer.h"

namespace mortise {

/// What a server says to clients: the writers of its topics, and the serial numbers of its samples.
/// Nothing here waits, but what ends it.
class ServerWriters {
 public:
  void open(Participant& participant, Status& status);
  /// Tells with the writers from now on that this server leads under another term.
  void change_term(Participant& participant, std::uint64_t term);
  /// Says what waits still, and waits until clients have what was said last, for at most so long.
  /// To be called before the participant goes.
  void close(double at_most_s);

  void say(const wire::Answers& answers) { write(answers_, answers); }
  void say(const JoinReply& reply) { say(to_wire(std::span(&reply, 1), {}, {})); }
  void say(std::span<const Reply> replies);
  void say(std::span<const RefusedIncrement> refused);
  void say(std::span<const Decision> decisions);
  void say(std::span<const StandingChange> changes);
  void say(std::span<const UploadState> uploads);
  void say(const PoseBatch& batch);
  void say(std::span<const ClashEvent> events);
  /// Said by a thread of its own, soon.
  void say(Snapshot snapshot) { snapshot_sayer_.add(std::move(snapshot)); }
  /// May be called by any thread.
  void say(const std::string& mesh_hash, std::span<const std::byte> mesh);
  void say(const FeatureTable& table);
  void say(const SessionPulse& pulse);

  /// Also a client that is still joining counts, so that nothing said meanwhile is lost.
  bool has_readers() const { return matched(poses_) || matched(events_) || matched(pulses_); }
  std::uint64_t failed() const { return failed_; }  ///< samples that were not taken

 private:
  void say_now(const Snapshot& snapshot);
  template <class Sample>
  void write(dds::DataWriter* writer, Sample sample) {
    if (!writer->write(&sample)) ++failed_;
  }

  dds::DataWriter *answers_ = nullptr, *poses_ = nullptr, *keyframes_ = nullptr, *events_ = nullptr,
                  *snapshots_ = nullptr, *meshes_ = nullptr, *features_ = nullptr,
                  *pulses_ = nullptr;
  std::uint64_t pose_serial_ = 0, keyframe_serial_ = 0, snapshot_serial_ = 0, feature_serial_ = 0;
  std::mutex mesh_mutex_;
  std::size_t mesh_chunks_ = 0;
  std::set<std::string> said_meshes_;
  std::atomic<std::uint64_t> failed_ = 0;
  SnapshotSayer snapshot_sayer_{[this](const Snapshot& snapshot) { say_now(snapshot); }};  ///< last
};

}  // namespace mortise
