#include "server/tick_recorder.h"

#include <utility>

#include "common/session/world/part_shapes.h"

namespace mortise {
namespace {

// Four seconds of a disk that does not follow.
constexpr std::size_t kMostQueued_ticks = 256;

std::int64_t in_ns(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

}  // namespace

TickRecorder::TickRecorder(World& world, SessionLogWriter* log, const CheckpointTimes& times)
    : world_(world), log_(log), times_(times) {
  for (const Part& part : world.parts) logged_.insert(part.solid->hash());
}

void TickRecorder::open(std::int64_t now_ns) {
  checkpoint_ns_ = now_ns;
  checkpoints_.begin(world_);
}

void TickRecorder::begin(const Stepped& stepped) {
  if (log_ == nullptr) return;
  record_ = log_->spare();
  record_.tick = stepped.tick;
  record_.time_ns = stepped.wall_ns;
  record_.step_ns = stepped.step_ns;
  worked_ns_ += stepped.step_ns;
  changed_since_checkpoint_ |= stepped.changed;
  // The last one at once: there are no ticks any more over which it could be made.
  record_.state = stepped.last ? StateDraft([bytes = encode_state(world_)] { return bytes; })
                               : checkpoints_.after_tick(world_, checkpoint_is_due(stepped.now_ns));
}

void TickRecorder::hand_over(std::vector<Decision>& decisions, std::vector<Increment>& increments,
                             StepReport& report) {
  if (record_.tick == 0) return;
  add_meshes(decisions);
  record_.decisions.swap(decisions);
  record_.increments.swap(increments);
  record_.report = std::move(report);
  log_->record(std::move(record_));
  record_.tick = 0;
}

void TickRecorder::add_meshes(const std::vector<Decision>& decisions) {
  for (const Decision& decision : decisions) {
    if (!decision.details.edit || !world_.shapes) continue;
    const SolidPtr solid = world_.shapes->find(decision.details.edit->mesh_hash).solid;
    if (solid && logged_.insert(solid->hash()).second) record_.meshes.push_back(solid);
  }
}

bool TickRecorder::checkpoint_is_due(std::int64_t now_ns) {
  if (checkpoints_.running()) return false;
  const std::int64_t age_ns = now_ns - checkpoint_ns_;
  const bool due = log_->wants_state() || worked_ns_ >= in_ns(times_.work_s) ||
                   age_ns >= in_ns(changed_since_checkpoint_ ? times_.changed_s : times_.idle_s);
  // A log that cannot follow, or is broken, would not take it.
  if (!due || log_->queued_ticks() > kMostQueued_ticks || !log_->status()) return false;
  worked_ns_ = 0;
  checkpoint_ns_ = now_ns;
  changed_since_checkpoint_ = false;
  return true;
}

}  // namespace mortise
