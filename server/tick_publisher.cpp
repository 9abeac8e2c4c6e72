#include "server/tick_publisher.h"

#include <set>
#include <utility>

#include "common/messages/mesh_bytes.h"
#include "common/session/guide/feature_table.h"
#include "common/session/world/standing.h"

namespace mortise {
namespace {

std::int64_t in_ns(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

}  // namespace

TickPublisher::TickPublisher(World& world, ServerChannel& channel, Clock& clock,
                             const PublishOptions& options)
    : world_(world), channel_(channel), clock_(clock), options_(options) {
  list_parts();
}

void TickPublisher::list_parts() {
  edits_ = world_.edits;
  moving_.clear();
  for (std::uint32_t i = 0; i < world_.parts.size(); ++i) {
    const Part& part = world_.parts[i];
    if (i == published_.size()) published_.push_back({part.id, part.holder, part.X_WP});
    if (part.present && part.moving) moving_.push_back(i);
  }
}

void TickPublisher::open(std::int64_t now_ns) {
  event_seq_ = snapshot_of(world_).event_seq;
  std::set<std::string> sent;
  for (const Part& part : world_.parts) {
    if (!sent.insert(part.solid->hash()).second) continue;
    const TriangleMesh& mesh = part.solid->mesh();
    channel_.publish_mesh(part.solid->hash(), mesh_to_bytes(mesh.points_mm, mesh.triangles));
  }
  standing_ = standing_decisions(world_);
  publish_snapshot(now_ns);
  channel_.publish_features(feature_table(world_));
  features_ns_ = now_ns;
  std::vector<SolidPtr> meshes = unrecognized_meshes(world_);
  if (!meshes.empty()) recognizer_ = std::make_unique<Recognizer>(std::move(meshes));
}

void TickPublisher::publish(const Intake& intake, const StepReport& report, std::int64_t now_ns) {
  if (edits_ != world_.edits) {
    list_parts();
    snapshot_wanted_ = true;
    features_are_due_ = true;
  }
  publish_answers(intake, report);
  publish_poses(intake, report);
  publish_snapshot_when_due(intake, now_ns);
  if (recognizer_ || features_are_due_ || tables_.is_busy()) publish_features_when_due(now_ns);
}

void TickPublisher::publish_answers(const Intake& intake, const StepReport& report) {
  for (const JoinReply& reply : intake.join_replies) channel_.publish_join_reply(reply);
  if (!intake.replies.empty()) channel_.publish_replies(intake.replies);
  if (!intake.decisions.empty()) publish_decisions(intake, report.tick);
  if (!intake.refused.empty()) channel_.publish_refusals(intake.refused);
  if (!report.refused.empty()) channel_.publish_refusals(report.refused);
  if (!intake.uploads.empty()) channel_.publish_uploads(intake.uploads);
  if (report.events.empty()) return;
  channel_.publish_events(report.events);
  event_seq_ = report.events.back().seq;
}

void TickPublisher::publish_decisions(const Intake& intake, std::uint64_t tick) {
  channel_.publish_decisions(intake.decisions);
  // Few of them change what stands, and what stands may be a thousand fits.
  if (are_standing(world_, standing_)) return;
  std::vector<Decision> standing = standing_decisions(world_);
  const auto changes = standing_changes(standing_, standing, tick);
  if (!changes.empty()) channel_.publish_standing(changes);
  standing_ = std::move(standing);
}

void TickPublisher::publish_poses(const Intake& intake, const StepReport& report) {
  PoseBatch batch;
  if (!intake.decisions.empty() || !report.moved.empty()) {
    changed_since_snapshot_ = true;
    for (const std::uint32_t i : moving_) {
      const Part& part = world_.parts[i];
      PartPose& last = published_[i];
      if (last.holder == part.holder && identical(last.X_WP, part.X_WP)) continue;
      last = {part.id, part.holder, part.X_WP};
      batch.parts.push_back(last);
    }
  }
  changed_since_snapshot_ |= !report.events.empty();
  batch.acks = intake.acks;
  const bool has_readers = channel_.has_readers();
  if (has_readers && (!batch.parts.empty() || !batch.acks.empty() || !report.events.empty())) {
    batch.tick = report.tick;
    batch.event_seq = event_seq_;
    batch.sent_ns = clock_.now_ns();
    channel_.publish_poses(batch);
  }
  // What was said to nobody is in the snapshot that the first reader finds.
  snapshot_wanted_ |= has_readers && !had_readers_ && changed_since_snapshot_;
  had_readers_ = has_readers;
}

void TickPublisher::publish_snapshot_when_due(const Intake& intake, std::int64_t now_ns) {
  const std::int64_t age_ns = now_ns - snapshot_ns_;
  const bool keyframe = changed_since_snapshot_ && age_ns >= in_ns(options_.keyframe_s);
  const bool asked = snapshot_wanted_ && age_ns >= in_ns(options_.snapshot_gap_s);
  if (intake.joined || keyframe || asked) publish_snapshot(now_ns);
}

void TickPublisher::publish_snapshot(std::int64_t now_ns) {
  Snapshot snapshot = snapshot_of(world_);
  snapshot.session = options_.session;
  snapshot.event_seq = event_seq_;
  channel_.publish_snapshot(std::move(snapshot));
  snapshot_ns_ = now_ns;
  changed_since_snapshot_ = false;
  snapshot_wanted_ = false;
}

void TickPublisher::publish_features_when_due(std::int64_t now_ns) {
  const bool done = !recognizer_ || recognizer_->done();
  if (recognizer_)
    for (auto& [mesh, features] : recognizer_->take()) {
      world_.recognized[mesh] = std::move(features);
      features_are_due_ = true;
    }
  if (recognizer_ && done) {
    recognizer_.reset();
    features_end_ = features_are_due_;
  }
  if (const auto table = tables_.take()) channel_.publish_features(*table);
  const bool gap = features_end_ || now_ns - features_ns_ >= in_ns(options_.features_gap_s);
  if (!features_are_due_ || !gap || tables_.is_busy()) return;
  tables_.make(feature_sources(world_));
  features_are_due_ = features_end_ = false;
  features_ns_ = now_ns;
}

}  // namespace mortise
