#include "client/report/moments.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string_view>

#include "common/io/log/replay.h"
#include "common/math/rotation.h"
#include "common/motion/motion.h"
#include "common/session/world/decisions.h"

namespace mortise {
namespace {

// Where in its tick a verdict was judged. The engine says it in front of the sentence, and nowhere
// else: "stopped at t = 0.7285: worst found at t = 0.9000: ...".
struct JudgedAt {
  bool as_asked = false;  // where the increments led, not where the part was left
  double t = 1.0;
};

JudgedAt judged_at(std::string_view sentence) {
  constexpr std::string_view kStopped = "stopped at t = ", kWorst = "worst found at t = ";
  JudgedAt at;
  if (sentence.starts_with(kStopped)) {
    at.as_asked = true;
    const auto end = sentence.find(": ");
    sentence.remove_prefix(end == std::string_view::npos ? sentence.size() : end + 2);
  }
  if (sentence.starts_with(kWorst))
    at.t = std::strtod(std::string(sentence.substr(kWorst.size(), 6)).c_str(), nullptr);
  return at;
}

bool was_refused(const StepReport& report, const Increment& increment) {
  return std::any_of(report.refused.begin(), report.refused.end(), [&](const auto& refused) {
    return refused.user == increment.user && refused.seq == increment.seq;
  });
}

// Eq. (1) of the paper, about the reference point, in order of arrival.
Pose asked_pose(const Part& part, Pose X_WP, const TickRecord& record) {
  const Vec3 reference_P = part.solid->sphere().center_mm;
  for (const Increment& increment : record.increments) {
    if (increment.part != part.id || was_refused(record.report, increment)) continue;
    const Vec3 reference_W = X_WP * reference_P + increment.translation_mm;
    X_WP.q = (rotation_exp(increment.rotation_rad) * X_WP.q).normalized();
    X_WP.p = reference_W - X_WP.q * reference_P;
  }
  return X_WP;
}

class Walk {
 public:
  Walk(World& world, const EventKeys& wanted, const std::function<void(const Moment&)>& visit)
      : world_(world), wanted_(wanted), visit_(visit) {}

  void take(const TickRecord& record) {
    for (const Decision& decision : record.decisions) apply_decision(world_, decision);
    world_.tick = record.tick;
    before_.clear();
    for (const PartPose& moved : record.report.moved) put(moved);
    for (const ClashEvent& event : record.report.events)
      if (wanted_.contains({event.tick, event.clash})) show(record, event);
  }

 private:
  void put(const PartPose& moved) {
    Part* part = world_.find(moved.part);
    if (part == nullptr) return;
    before_[moved.part] = part->X_WP;
    part->history.note(moved.holder, part->X_WP);
    part->X_WP = moved.X_WP;
  }

  void show(const TickRecord& record, const ClashEvent& event) {
    const JudgedAt at = judged_at(event.verdict.explanation);
    const PartId ids[2] = {event.part_a, event.part_b};
    Pose kept[2];
    for (int i = 0; i < 2; ++i)
      if (const Part* part = world_.find(ids[i]); part == nullptr) return;
    for (int i = 0; i < 2; ++i) {
      Part& part = *world_.find(ids[i]);
      kept[i] = part.X_WP;
      const auto found = before_.find(part.id);
      const Pose start = found == before_.end() ? part.X_WP : found->second;
      const bool bound = part.group || std::any_of(world_.guides.begin(), world_.guides.end(),
                                                   [&](const Guide& guide) {
                                                     return guide.constraint.held.part == part.id;
                                                   });
      const Pose end = at.as_asked && !bound ? asked_pose(part, start, record) : part.X_WP;
      part.X_WP = at.t >= 1.0
                      ? end
                      : linear_motion(start, end, part.solid->sphere().center_mm).pose_at(at.t);
    }
    visit_({world_, event});
    for (int i = 0; i < 2; ++i) world_.find(ids[i])->X_WP = kept[i];
  }

  World& world_;
  const EventKeys& wanted_;
  const std::function<void(const Moment&)>& visit_;
  std::map<PartId, Pose> before_;  // this tick, of parts that moved in it
};

}  // namespace

Status for_moments(const SessionLog& log, const EventKeys& wanted,
                   const std::function<void(const Moment&)>& visit) {
  if (wanted.empty()) return ok();
  auto scene = scene_of(log);
  if (!scene) return scene.error();
  Walk walk(scene->world, wanted, visit);
  for (const TickRecord& record : log.ticks) walk.take(record);
  return ok();
}

Result<LoadedScene> scene_after(const SessionLog& log, std::uint64_t tick) {
  auto scene = scene_of(log);
  if (!scene) return scene;
  const EventKeys none;
  const std::function<void(const Moment&)> visit;
  Walk walk(scene->world, none, visit);
  for (const TickRecord& record : log.ticks)
    if (record.tick <= tick) walk.take(record);
  return scene;
}

}  // namespace mortise
