#include "client/web/live_feed.h"

#include <algorithm>

#include "client/web/features_json.h"

namespace mortise::web {

void LiveFeed::enter(Viewer& viewer) {
  seats_.enter(viewer);
  viewer.say(text_of(
      {{"type", "server"}, {"present", client_.server_present()}, {"session", client_.session()}}));
  if (!has_scene_) return;
  viewer.show_scene(scene());
  if (client_.features().told()) viewer.say(text_of(features_message(client_)));
}

void LiveFeed::turn(double now_s) {
  seats_.begin_turn(now_s);
  const ClientUpdate update = client_.poll();
  if (update.server_lost) {
    has_scene_ = false;
    seats_.forget_answers();
  }
  take_meshes(update);
  tell_server();
  seats_.tell_joins(update);
  // What is edited is told as a scene: which parts there are, and where.
  const bool scene_is_new = update.resynced || (update.scene && has_scene_);
  if (scene_is_new) {
    has_scene_ = true;
    with_changed_classes(update);
    const SharedBytes text = scene();
    seats_.each([&](Viewer& viewer) { viewer.show_scene(text); });
  }
  // After a scene pages want all that belongs to it.
  if (has_scene_ && client_.features().told() && (update.features || scene_is_new))
    seats_.tell_all(features_message(client_));
  seats_.tell_replies(update);
  if (has_scene_) {
    tell_decisions(update);
    if (update.standing && !scene_is_new)
      seats_.tell_all(message_of_list("standing", "standing", client_.standing()));
    if (update.remarks && !scene_is_new)
      seats_.tell_all(message_of_list("remarks", "remarks", client_.remarks()));
    if (!update.events.empty()) seats_.tell_all(message_of_list("events", "events", update.events));
    if (!scene_is_new) tell_changes(update);
  }
  seats_.end_turn(update);
}

void LiveFeed::tell_server() {
  if (present_ == client_.server_present()) return;
  present_ = client_.server_present();
  seats_.tell_all({{"type", "server"}, {"present", present_}, {"session", client_.session()}});
}

void LiveFeed::tell_decisions(const ClientUpdate& update) {
  if (update.decisions.empty()) return;
  seats_.tell_all(message_of_list("decisions", "decisions", update.decisions));
  using Kind = Decision::Kind;
  const auto is_presence = [](const Decision& decision) {
    return decision.kind == Kind::kJoin || decision.kind == Kind::kLeave ||
           decision.kind == Kind::kLivelinessLost;
  };
  if (std::any_of(update.decisions.begin(), update.decisions.end(), is_presence))
    seats_.tell_all(message_of_list("users", "users", client_.users()));
}

void LiveFeed::tell_changes(const ClientUpdate& update) {
  std::vector<PartId> changed = with_changed_classes(update);
  changed.insert(changed.end(), update.changed.begin(), update.changed.end());
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  if (changed.empty() || seats_.empty()) return;
  const SharedBytes bytes = frame_of(changed);
  seats_.each([&](Viewer& viewer) { viewer.changed(changed, bytes); });
}

std::vector<PartId> LiveFeed::with_changed_classes(const ClientUpdate& update) {
  if (update.events.empty() && !update.resynced && !update.scene) return {};
  std::vector<ClashEvent> open;
  for (const auto& [id, clash] : client_.open_clashes()) open.push_back(clash);
  ClassBits now = class_bits_of(open);
  std::vector<PartId> changed;
  for (const auto& [part, info] : client_.parts()) {
    if (now[part] != classes_[part]) changed.push_back(part);
  }
  classes_ = std::move(now);
  return changed;
}

void LiveFeed::take_meshes(const ClientUpdate& update) {
  for (const MeshBytes& mesh : update.meshes) {
    const auto read = mesh_from_bytes(mesh.bytes);
    if (!read) continue;  // the page goes on waiting; the channel checks hashes
    meshes_.put(mesh.hash, *read);
    seats_.tell_all({{"type", "mesh"}, {"hash", mesh.hash}});
  }
}

SharedBytes LiveFeed::scene() {
  Scene scene;
  scene.session = client_.session();
  scene.policy = client_.policy();
  scene.tick = client_.statistics().highest_tick;
  scene.tick_rate_hz = client_.tick_rate_hz();
  for (const auto& [id, part] : client_.parts()) scene.parts.push_back(part.info);
  scene.users = client_.users();
  for (const auto& [id, clash] : client_.open_clashes()) scene.clashes.push_back(clash);
  scene.standing = client_.standing();
  scene.notes = client_.notes();
  scene.remarks = client_.remarks();
  meshes_.expect(scene.parts);
  return text_of(json_of(scene, classes_));
}

SharedBytes LiveFeed::frame_of(const std::vector<PartId>& parts) const {
  std::vector<PartState> states;
  std::uint64_t tick = 0;
  for (const PartId id : parts) {
    const auto found = client_.parts().find(id);
    if (found == client_.parts().end()) continue;
    const KnownPart& part = found->second;
    const auto bits = classes_.find(id);
    states.push_back(
        {id, part.info.holder, part.info.X_WP, bits == classes_.end() ? 0u : bits->second});
    tick = std::max(tick, part.tick);
  }
  return std::make_shared<const std::string>(pose_frame(tick, states));
}

SharedBytes LiveFeed::frame(const Viewer&, const std::vector<PartId>& parts) const {
  return frame_of(parts);
}

std::string LiveFeed::trouble() const {
  if (!client_.server_present()) return "the session has no server at present";
  return has_scene_ ? "" : "the server has not sent the scene yet";
}

Json LiveFeed::statistics() const {
  const ClientStatistics s = client_.statistics();
  return {{"mode", "live"},
          {"session", client_.session()},
          {"server_present", client_.server_present()},
          {"parts", client_.parts().size()},
          {"meshes", meshes_.size()},
          {"events_applied", s.events_applied},
          {"event_gaps", s.gaps},
          {"snapshots_applied", s.snapshots_applied},
          {"poses_missed", s.poses_missed},
          {"increments_sent", s.increments_sent},
          {"increments_repeated", s.increments_repeated},
          {"server_losses", s.server_losses},
          {"joins_under_another_name", seats_.foreign_names()},
          {"highest_tick", s.highest_tick}};
}

}  // namespace mortise::web
