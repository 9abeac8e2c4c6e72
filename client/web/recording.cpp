#include "client/web/recording.h"

#include <algorithm>

#include "client/event_stream.h"
#include "common/io/log/log_chain.h"
#include "common/io/log/replay.h"

namespace mortise::web {
namespace {

template <class Rows>
auto rows_between(const Rows& rows, std::uint64_t from, std::uint64_t to) {
  const auto after = [](std::uint64_t tick, const auto& row) { return tick < row.tick; };
  return std::pair(std::upper_bound(rows.begin(), rows.end(), from, after),
                   std::upper_bound(rows.begin(), rows.end(), to, after));
}

PartState state_of(const Part& part) { return {part.id, part.holder, part.X_WP, 0}; }

Recording::Agreement agreement_of(const World& world, std::vector<Decision> decisions) {
  Snapshot now = snapshot_of(world);
  return {world.tick,
          std::move(now.policy),
          std::move(now.users),
          std::move(now.standing),
          std::move(now.remarks),
          std::move(decisions)};
}

SharedBytes mesh_of(const TriangleMesh& mesh) {
  WireMesh wire;
  wire.points_mm = mesh.points_mm;
  wire.triangles = mesh.triangles;
  return std::make_shared<const std::string>(page_mesh(wire));
}

/// Keeps what changed in each tick.
class Recorder {
 public:
  Recorder(Recording& recording, const World& world) : recording_(recording) { list_parts(world); }
  void take(const ReplayedTick& tick) {
    if (tick.world.edits != edits_) list_parts(tick.world);
    for (std::size_t i = 0; i < last_.size(); ++i) {
      const Part& part = tick.world.parts[i];
      if (part.holder == last_[i].holder && identical(part.X_WP, last_[i].X_WP)) continue;
      last_[i] = state_of(part);
      recording_.steps[part.id].push_back({tick.computed.tick, last_[i]});
    }
    recording_.events.insert(recording_.events.end(), tick.computed.events.begin(),
                             tick.computed.events.end());
    if (tick.logged != nullptr && !tick.logged->decisions.empty())
      recording_.agreements.push_back(agreement_of(tick.world, tick.logged->decisions));
    recording_.last_tick = tick.computed.tick;
  }

 private:
  void list_parts(const World& world) {
    edits_ = world.edits;
    while (last_.size() < world.parts.size()) last_.push_back(state_of(world.parts[last_.size()]));
    Snapshot now = snapshot_of(world);
    recording_.part_lists.push_back({world.tick, std::move(now.parts), std::move(now.notes)});
  }

  Recording& recording_;
  std::uint64_t edits_ = 0;  ///< World::edits of the last list
  std::vector<PartState> last_;
};

}  // namespace

const Recording::Agreement& Recording::agreement_at(std::uint64_t tick) const {
  return *std::prev(rows_between(agreements, tick, tick).second);
}

const Recording::PartList& Recording::parts_at(std::uint64_t tick) const {
  const auto after = rows_between(part_lists, tick, tick).second;
  return after == part_lists.begin() ? *after : *std::prev(after);
}

PartState Recording::state_at(PartId part, std::uint64_t tick) const {
  const auto found = steps.find(part);
  if (found != steps.end()) {
    const auto after = rows_between(found->second, tick, tick).second;
    if (after != found->second.begin()) return std::prev(after)->state;
  }
  for (const PartInfo& info : parts_at(tick).parts)
    if (info.part == part) return {part, UserId{}, info.X_WP, 0};
  return {part, UserId{}, Pose{}, 0};
}

std::vector<PartId> Recording::moved_between(std::uint64_t from, std::uint64_t to) const {
  std::vector<PartId> moved;
  for (const auto& [part, rows] : steps) {
    const auto [begin, end] = rows_between(rows, from, to);
    if (begin != end) moved.push_back(part);
  }
  return moved;
}

Scene Recording::scene_at(std::uint64_t tick) const {
  const Agreement& agreement = agreement_at(tick);
  const PartList& list = parts_at(tick);
  Scene scene{session,    agreement.policy, tick, tick_rate_hz,
              list.parts, agreement.users,  {},   agreement.standing,
              list.notes, agreement.remarks};
  for (PartInfo& part : scene.parts) {
    const PartState state = state_at(part.part, tick);
    part.X_WP = state.X_WP;
    part.holder = state.holder;
  }
  std::map<ClashId, ClashEvent> open;
  for (const ClashEvent& event : events) {
    if (event.tick > tick) break;
    note_event(event, open);
  }
  for (auto& [id, clash] : open) scene.clashes.push_back(std::move(clash));
  return scene;
}

Result<Recording> read_recording(const std::filesystem::path& file) {
  auto log = read_session(file);
  if (!log) return log.error();
  auto loaded = scene_of(*log);
  if (!loaded) return loaded.error();
  World& world = loaded->world;
  Recording recording;
  recording.session = log->session;
  recording.tick_rate_hz = world.tick_rate_hz;
  recording.first_tick = recording.last_tick = world.tick;
  recording.notes = log->notes;
  recording.tick_times = log->times;
  recording.agreements.push_back(agreement_of(world, {}));
  for (const auto& [hash, mesh] : log->meshes) recording.meshes[hash] = mesh_of(mesh);
  Recorder recorder(recording, world);
  const auto replayed = replay(
      world, *log, 1, [&](const ReplayedTick& tick) { recorder.take(tick); },
      agreement_to_ask(*log));
  if (!replayed) return replayed.error();
  if (!replayed->same_build)
    recording.notes.push_back("recorded by another build (" + log->engine_version +
                              "): compared within accuracy, not to the last bit");
  if (replayed->difference) {
    recording.notes.push_back(
        "it ends at tick " + std::to_string(replayed->difference->tick) +
        ", where this engine disagrees with the log: " + replayed->difference->what);
  }
  if (!replayed->not_verifiable.empty()) recording.notes.push_back(replayed->not_verifiable);
  return recording;
}

}  // namespace mortise::web
