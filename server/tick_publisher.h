#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/messages/channel.h"
#include "common/session/world/world.h"
#include "server/clock.h"
#include "server/intake.h"
#include "server/recognizer.h"
#include "server/table_maker.h"

namespace mortise {

struct PublishOptions {
  std::string session = "default";
  double keyframe_s = 1.0;  ///< period of snapshots while something changes
  /// Least time between two requested snapshots: a client that asks in a loop costs little.
  double snapshot_gap_s = 0.1;
  double features_gap_s = 1.0;  ///< likewise of feature tables, while meshes are searched
};

/// Publishes to clients what a tick has changed: answers, events, poses, snapshots and features.
class TickPublisher {
 public:
  /// All references must outlive this.
  TickPublisher(World& world, ServerChannel& channel, Clock& clock, const PublishOptions& options);

  /// Publishes the meshes, once per distinct hash, and the first snapshot.
  void open(std::int64_t now_ns);
  /// A client has requested a snapshot.
  void want_snapshot() { snapshot_wanted_ = true; }
  /// What went into a tick, and what came of it.
  void publish(const Intake& intake, const StepReport& report, std::int64_t now_ns);
  void publish_snapshot(std::int64_t now_ns);
  bool has_readers() const { return had_readers_; }  ///< at the last publish()

 private:
  void list_parts();
  void publish_answers(const Intake& intake, const StepReport& report);
  void publish_decisions(const Intake& intake, std::uint64_t tick);
  void publish_poses(const Intake& intake, const StepReport& report);
  void publish_snapshot_when_due(const Intake& intake, std::int64_t now_ns);
  void publish_features_when_due(std::int64_t now_ns);

  World& world_;
  ServerChannel& channel_;
  Clock& clock_;
  PublishOptions options_;
  std::vector<PartPose> published_;         ///< the last poses of the stream, by part index
  std::vector<Decision> standing_;          ///< decisions in force, as told last
  std::vector<std::uint32_t> moving_;       ///< parts that can move, by index
  std::unique_ptr<Recognizer> recognizer_;  ///< null: no mesh is searched any more
  TableMaker tables_;
  std::uint64_t event_seq_ = 0;
  std::int64_t snapshot_ns_ = 0, features_ns_ = 0;
  std::uint64_t edits_ = 0;  ///< World::edits when the lists were made
  bool features_are_due_ = false;
  bool features_end_ = false;  ///< all meshes are searched, and the last table is not yet begun
  bool changed_since_snapshot_ = false, snapshot_wanted_ = false;
  bool had_readers_ = false;
};

}  // namespace mortise
