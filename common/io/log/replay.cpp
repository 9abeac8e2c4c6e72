#include "common/io/log/replay.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "common/base/constants.h"
#include "common/base/hash.h"
#include "common/io/build_info.h"
#include "common/io/log/log_json.h"
#include "common/io/state/checkpoint.h"
#include "common/messages/names.h"
#include "common/session/tick/step.h"
#include "common/session/world/decisions.h"

namespace mortise {
namespace {

// A part is called moved away beyond this. Logged places are rounded to floats, which is less up to
// 80 m from the origin.
constexpr double kRoundedPose_mm = 1e-2;

// Of a coordinate that was rounded to a float, as a share of it.
constexpr double kLogPoseRounding = 1.2e-7;

std::string hex(std::uint64_t value) {
  char text[19];
  std::snprintf(text, sizeof text, "0x%016llx", static_cast<unsigned long long>(value));
  return text;
}

std::string describe(const ClashEvent& event) {
  return std::string(name_of(event.kind)) + " of clash " + std::to_string(event.clash.value) +
         " between parts " + std::to_string(event.part_a.value) + " and " +
         std::to_string(event.part_b.value) + " (" + std::string(name_of(event.worst_class)) + ")";
}
std::string describe(const RefusedIncrement& refused) {
  return "increment " + std::to_string(refused.seq) + " of user " +
         std::to_string(refused.user.value) + " refused: " + std::string(name_of(refused.reason));
}

bool same(const RefusedIncrement& a, const RefusedIncrement& b) {
  return a.user == b.user && a.part == b.part && a.seq == b.seq && a.reason == b.reason;
}

std::string compare_refusals(const StepReport& logged, const StepReport& computed) {
  const auto &a = logged.refused, &b = computed.refused;
  for (std::size_t i = 0; i < a.size() || i < b.size(); ++i) {
    if (i >= b.size()) return describe(a[i]) + ", which the replay accepts";
    if (i >= a.size()) return describe(b[i]) + ", which the log does not have";
    if (!same(a[i], b[i])) return "logged " + describe(a[i]) + "; computed " + describe(b[i]);
  }
  return {};
}

std::string compare_events(const StepReport& logged, const StepReport& computed) {
  const auto &a = logged.events, &b = computed.events;
  for (std::size_t i = 0; i < a.size() || i < b.size(); ++i) {
    if (i >= b.size()) return describe(a[i]) + " is in the log only";
    if (i >= a.size()) return describe(b[i]) + " is in the replay only";
    if (const std::string difference = log_json::first_difference(a[i], b[i]); !difference.empty())
      return describe(b[i]) + ": " + difference;
  }
  return {};
}

// Depth of the same place by two builds.
bool brackets_meet(Interval a, Interval b) {
  return a.lo <= b.hi + kDepthAccuracyDefault_mm && b.lo <= a.hi + kDepthAccuracyDefault_mm;
}

std::string compare_events_within_accuracy(const StepReport& logged, const StepReport& computed) {
  const auto &a = logged.events, &b = computed.events;
  if (a.size() != b.size()) return compare_events(logged, computed);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool same = a[i].kind == b[i].kind && a[i].seq == b[i].seq && a[i].clash == b[i].clash &&
                      a[i].part_a == b[i].part_a && a[i].part_b == b[i].part_b &&
                      a[i].verdict.collision_class == b[i].verdict.collision_class &&
                      a[i].worst_class == b[i].worst_class &&
                      brackets_meet(a[i].verdict.delta_mm, b[i].verdict.delta_mm);
    if (!same)
      return describe(b[i]) + ", logged as " + describe(a[i]) + ": " +
             log_json::first_difference(a[i], b[i]);
  }
  return {};
}

// Largest distance of a moved part from where the log has it, beyond the rounding of the log.
double pose_off_mm(const StepReport& logged, const World& world) {
  double largest = 0.0;
  for (const PartPose& pose : logged.moved) {
    const Part* part = world.find(pose.part);
    if (part == nullptr) continue;
    const double rounding_mm = kLogPoseRounding * pose.X_WP.p.norm();
    largest = std::max(largest, (part->X_WP.p - pose.X_WP.p).norm() - rounding_mm);
  }
  return largest;
}

std::string compare_hash(const StepReport& logged, const StepReport& computed, const World& world) {
  if (logged.state_hash == computed.state_hash) return {};
  std::string what =
      "state hash: logged " + hex(logged.state_hash) + ", computed " + hex(computed.state_hash);
  for (const PartPose& pose : logged.moved) {
    const Part* part = world.find(pose.part);
    if (part == nullptr) continue;
    const double away_mm = (part->X_WP.p - pose.X_WP.p).norm();
    if (away_mm > kRoundedPose_mm)
      what += "; part " + part->name + " is " + std::to_string(away_mm) + " mm away";
  }
  return what;
}

}  // namespace

Result<LoadedScene> bare_scene_of(const SessionLog& log) {
  auto reading = scenario_of(log);
  if (!reading) return reading.error();
  for (const Finding& finding : reading->findings)
    if (finding.is_error) return fail(Code::kInvalidInput, "scenario of the log: " + finding.text);
  const MeshProvider from_log = [&log](const Scenario& scenario,
                                       const Scenario::PartSpec& part) -> Result<ImportedMesh> {
    std::size_t index = 0;
    while (index < scenario.parts.size() && scenario.parts[index].name != part.name) ++index;
    if (index >= log.mesh_of_part.size())
      return fail(Code::kInvalidInput, "the log names no mesh for part " + part.name);
    for (const auto& [hash, mesh] : log.meshes)
      if (hash == log.mesh_of_part[index])
        return ImportedMesh{mesh, index < log.imports.size() ? log.imports[index] : ImportReport{}};
    if (part.mesh.given && mesh_hash(part.mesh.given->mesh) == log.mesh_of_part[index])
      return default_meshes()(scenario, part);
    // What a generator made it makes again, bit for bit, or the hash tells.
    if (!part.mesh.generator.empty())
      if (auto again = default_meshes()(scenario, part);
          again && mesh_hash(again->mesh) == log.mesh_of_part[index])
        return again;
    return fail(Code::kInvalidInput, "mesh " + log.mesh_of_part[index] + " of part " + part.name +
                                         " is missing from the log or damaged");
  };
  auto scene = load_scene(reading->scenario, from_log);
  if (!scene) return scene.error();
  for (const Finding& finding : scene->findings)
    if (finding.is_error) return fail(Code::kInvalidInput, "scene of the log: " + finding.text);
  // Of parts that were added later. What is known of their corners is said where they are.
  if (scene->world.shapes)
    for (const auto& [hash, mesh] : log.meshes)
      if (!scene->world.shapes->find(hash).solid)
        scene->world.shapes->add(std::make_shared<const Solid>(mesh), 0.0);
  return scene;
}

Result<LoadedScene> scene_of(const SessionLog& log) {
  auto scene = bare_scene_of(log);
  if (!scene || !log.begin) return scene;
  if (Status restored = restore_state(scene->world, log.begin->state.bytes); !restored)
    return fail(Code::kInvalidInput,
                "the state at the beginning of the log cannot be used: " + restored.error().text);
  return scene;
}

Result<SceneAtCheckpoint> scene_at_last_checkpoint(const SessionLog& log) {
  SceneAtCheckpoint at;
  for (auto state = log.checkpoints.rbegin(); state != log.checkpoints.rend(); ++state) {
    if (state->bytes.empty()) break;  // nor are those before it kept
    const auto pass_over = [&](const std::string& why) {
      at.notes.push_back("the checkpoint after tick " + std::to_string(state->tick) +
                         " is passed over: " + why);
    };
    if (state->build != build_fingerprint()) {
      pass_over("it was written by another build");
      continue;
    }
    auto scene = bare_scene_of(log);
    if (!scene) return scene.error();
    if (Status restored = restore_state(scene->world, state->bytes); !restored) {
      pass_over(restored.error().text);
      continue;
    }
    at.scene = std::move(*scene);
    at.tick = at.scene.world.tick;
    at.from_checkpoint = true;
    return at;
  }
  auto scene = scene_of(log);
  if (!scene) return scene.error();
  at.scene = std::move(*scene);
  at.tick = at.scene.world.tick;
  return at;
}

namespace {

// Steps through a log: the record's tick, and those before it that had no input, for which `logged`
// is null. visit says whether to go on. Returns why the log ends before its last tick, or nothing.
Result<std::string> walk(World& world, const SessionLog& log, int threads,
                         const std::function<bool(const ReplayedTick&)>& visit) {
  Scratch scratch(threads);
  const std::uint64_t begun_at = world.tick;
  std::int64_t before_ns = log.begin ? log.begin->time_ns : 0;
  auto gap = log.gaps.begin();
  for (const TickRecord& record : log.ticks) {
    const std::int64_t from_ns = std::exchange(before_ns, record.time_ns);
    if (begun_at > 0 && record.tick <= begun_at) continue;
    // 1. What was lost before this tick cannot be computed, nor anything after it.
    while (gap != log.gaps.end() && gap->until_tick < record.tick) ++gap;
    if (gap != log.gaps.end() && gap->until_tick == record.tick)
      return "ticks between " + std::to_string(gap->after_tick) + " and " +
             std::to_string(gap->until_tick) + " are missing: " + gap->reason;
    if (record.tick <= world.tick ||
        record.tick - world.tick > most_idle_ticks(world.tick_rate_hz, from_ns, record.time_ns))
      return fail(Code::kInvalidInput, "tick " + std::to_string(record.tick) + " follows tick " +
                                           std::to_string(world.tick) + ": the log is damaged");
    // 2. Ticks in between had no input; they still count for how long a clash lasts.
    while (world.tick + 1 < record.tick) {
      const StepReport idle = step(world, {}, scratch);
      if (!visit({world, idle, nullptr})) return std::string();
    }
    // 3. The tick itself.
    for (const Decision& decision : record.decisions) apply_decision(world, decision);
    const StepReport computed = step(world, record.increments, scratch);
    if (!visit({world, computed, &record})) return std::string();
  }
  return cut_off_of(log);
}

// Nothing where they agree.
std::string difference_of(const ReplayedTick& tick) {
  if (tick.logged == nullptr) return compare_events({}, tick.computed);
  const StepReport& logged = tick.logged->report;
  std::string what = compare_refusals(logged, tick.computed);
  if (what.empty()) what = compare_events(logged, tick.computed);
  if (what.empty()) what = compare_hash(logged, tick.computed, tick.world);
  return what;
}

}  // namespace

namespace {

std::string difference_within_accuracy(const ReplayedTick& tick, double& largest_off_mm) {
  const StepReport none;
  const StepReport& logged = tick.logged == nullptr ? none : tick.logged->report;
  std::string what = compare_refusals(logged, tick.computed);
  if (what.empty()) what = compare_events_within_accuracy(logged, tick.computed);
  const double off_mm = pose_off_mm(logged, tick.world);
  largest_off_mm = std::max(largest_off_mm, off_mm);
  if (what.empty() && !(off_mm <= kOtherBuild_mm))
    what = "a part is " + std::to_string(off_mm) + " mm from where the log has it";
  return what;
}

}  // namespace

Agreement agreement_to_ask(const SessionLog& log) {
  return log.build_fingerprint == build_fingerprint() ? Agreement::kBitForBit
                                                      : Agreement::kWithinAccuracy;
}

Result<ReplayReport> replay(World& world, const SessionLog& log, int threads,
                            const OnReplayedTick& on_tick, Agreement agreement,
                            const std::function<bool()>& stop) {
  ReplayReport report;
  report.bit_for_bit = agreement == Agreement::kBitForBit;
  report.ticks_logged = log.ticks.size();
  report.same_build = log.build_fingerprint == build_fingerprint();
  report.verified_to_tick = world.tick;
  auto next = log.checkpoints.begin();
  const auto end = walk(world, log, threads, [&](const ReplayedTick& tick) {
    if (tick.logged == nullptr) {
      ++report.idle_ticks;
    } else {
      report.increments += tick.logged->increments.size();
      report.decisions += tick.logged->decisions.size();
      report.events_compared += tick.logged->report.events.size();
      ++report.ticks_compared;
    }
    if (on_tick) on_tick(tick);
    std::string what = report.bit_for_bit
                           ? difference_of(tick)
                           : difference_within_accuracy(tick, report.largest_pose_off_mm);
    while (next != log.checkpoints.end() && next->tick < tick.computed.tick) ++next;
    if (what.empty() && report.bit_for_bit && next != log.checkpoints.end() &&
        next->tick == tick.computed.tick && next->build == build_fingerprint()) {
      ++report.checkpoints_compared;
      if (content_hash(encode_state(tick.world)) != next->hash)
        what =
            "the checkpoint in the log differs from the state computed here, although all events "
            "agree";
    }
    if (!what.empty()) {
      report.difference = ReplayDifference{tick.computed.tick, std::move(what)};
      return false;
    }
    if (tick.logged != nullptr) report.verified_to_tick = tick.computed.tick;
    report.stopped = stop && stop();
    return !report.stopped;
  });
  if (!end) return end.error();
  report.not_verifiable = *end;
  return report;
}

Result<Recomputation> recompute(World& world, const SessionLog& log, int threads,
                                const OnReplayedTick& on_tick) {
  Recomputation done;
  const auto end = walk(world, log, threads, [&](const ReplayedTick& tick) {
    ++done.ticks;
    on_tick(tick);
    return true;
  });
  if (!end) return end.error();
  done.stopped_early = *end;
  return done;
}

Result<ReplayReport> verify(const SessionLog& log, int threads,
                            const std::function<void(const World&, const StepReport&)>& on_tick) {
  auto scene = scene_of(log);
  if (!scene) return scene.error();
  OnReplayedTick each;
  if (on_tick) each = [&](const ReplayedTick& tick) { on_tick(tick.world, tick.computed); };
  return replay(scene->world, log, threads, each, agreement_to_ask(log));
}

}  // namespace mortise
