#include "client/web/replay_feed.h"

#include <algorithm>
#include <cmath>

#include "client/web/recording_timeline.h"
#include "common/messages/names.h"

namespace mortise::web {
namespace {

// The position of the timeline; the page moves its hand in between by itself.
constexpr double kTellEvery_s = 0.25;

}  // namespace

void ReplayFeed::enter(Viewer& viewer) {
  Cursor& cursor = cursors_[&viewer];
  viewer.say(text_of(timeline_of(recording_)));
  show(viewer, cursor, recording_.first_tick);
}

Status ReplayFeed::take(Viewer& viewer, const PageMessage& message) {
  Cursor& cursor = cursors_.at(&viewer);
  if (const auto* wish = std::get_if<ReplayWish>(&message)) {
    steer(viewer, cursor, *wish);
  } else if (const auto* ping = std::get_if<PingWish>(&message)) {
    viewer.say(text_of({{"type", "pong"}, {"at", ping->at}}));
  } else if (const auto* command = std::get_if<CommandWish>(&message)) {
    viewer.say(text_of({{"type", "reply"},
                        {"id", command->id},
                        {"done", false},
                        {"refusal", name_of(Refusal::kObserver)},
                        {"text", "this is a replay: nothing can be changed"},
                        {"part", command->part.value},
                        {"holder", 0}}));
  } else if (std::holds_alternative<JoinWish>(message)) {
    viewer.say(text_of({{"type", "join_refused"}, {"text", "nobody can join a replay"}}));
  } else if (!std::holds_alternative<ViewWish>(message)) {
    return fail(Code::kInvalidInput, "this is a replay: nothing can be moved");
  }
  return ok();
}

void ReplayFeed::steer(Viewer& viewer, Cursor& cursor, const ReplayWish& wish) {
  switch (wish.what) {
    case ReplayWish::Do::kPlay:
      // From the end it begins again.
      if (cursor.tick == recording_.last_tick) show(viewer, cursor, recording_.first_tick);
      cursor.playing = true;
      break;
    case ReplayWish::Do::kPause:
      cursor.playing = false;
      break;
    case ReplayWish::Do::kSeek:
      return show(viewer, cursor,
                  std::clamp(wish.tick, recording_.first_tick, recording_.last_tick));
    case ReplayWish::Do::kSpeed:
      cursor.speed = wish.speed;
      break;
    case ReplayWish::Do::kUnknown:
      return;
  }
  tell(viewer, cursor);
}

void ReplayFeed::show(Viewer& viewer, Cursor& cursor, std::uint64_t tick) {
  const Scene scene = recording_.scene_at(tick);
  cursor.tick = tick;
  cursor.ahead = 0.0;
  cursor.open = scene.clashes;
  cursor.classes = class_bits_of(cursor.open);
  viewer.show_scene(text_of(json_of(scene, cursor.classes)));
  tell(viewer, cursor);
}

void ReplayFeed::turn(double now_s) {
  const double passed_s = now_s_ > 0.0 ? now_s - now_s_ : 0.0;
  now_s_ = now_s;
  for (auto& [viewer, cursor] : cursors_) {
    if (!cursor.playing) continue;
    cursor.ahead += passed_s * cursor.speed * recording_.tick_rate_hz;
    const auto ticks = static_cast<std::uint64_t>(std::floor(cursor.ahead));
    if (ticks == 0) continue;
    cursor.ahead -= static_cast<double>(ticks);
    play_to(*viewer, cursor, std::min(cursor.tick + ticks, recording_.last_tick));
    if (cursor.tick == recording_.last_tick) cursor.playing = false;
    if (!cursor.playing || now_s - cursor.told_s >= kTellEvery_s) tell(*viewer, cursor);
  }
}

void ReplayFeed::play_to(Viewer& viewer, Cursor& cursor, std::uint64_t tick) {
  tell_decisions(viewer, cursor.tick, tick);
  if (&recording_.parts_at(cursor.tick) != &recording_.parts_at(tick))
    return show(viewer, cursor, tick);
  std::vector<PartId> changed = take_events(viewer, cursor, tick);
  const std::vector<PartId> moved = recording_.moved_between(cursor.tick, tick);
  cursor.tick = tick;
  changed.insert(changed.end(), moved.begin(), moved.end());
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  if (!changed.empty()) viewer.changed(changed, frame_at(cursor, changed));
}

// Says the events up to a tick; the parts whose class is another after them.
std::vector<PartId> ReplayFeed::take_events(Viewer& viewer, Cursor& cursor, std::uint64_t to) {
  const auto& all = recording_.events;
  std::vector<ClashEvent> now;
  const auto later = [](std::uint64_t tick, const ClashEvent& event) { return tick < event.tick; };
  for (auto event = std::upper_bound(all.begin(), all.end(), cursor.tick, later);
       event != all.end() && event->tick <= to; ++event) {
    now.push_back(*event);
    std::erase_if(cursor.open, [&](const ClashEvent& c) { return c.clash == event->clash; });
    if (event->kind != ClashEvent::Kind::kEnd) cursor.open.push_back(*event);
  }
  if (now.empty()) return {};
  viewer.say(text_of(message_of_list("events", "events", now)));
  ClassBits bits = class_bits_of(cursor.open);
  std::vector<PartId> changed;
  for (const PartInfo& part : recording_.parts_at(to).parts)
    if (bits[part.part] != cursor.classes[part.part]) changed.push_back(part.part);
  cursor.classes = std::move(bits);
  return changed;
}

void ReplayFeed::tell_decisions(Viewer& viewer, std::uint64_t from, std::uint64_t to) const {
  for (const Recording::Agreement& agreement : recording_.agreements) {
    if (agreement.tick <= from || agreement.tick > to || agreement.decisions.empty()) continue;
    viewer.say(text_of(message_of_list("decisions", "decisions", agreement.decisions)));
    viewer.say(text_of(message_of_list("users", "users", agreement.users)));
    viewer.say(text_of(message_of_list("standing", "standing", agreement.standing)));
    viewer.say(text_of(message_of_list("remarks", "remarks", agreement.remarks)));
  }
}

void ReplayFeed::tell(Viewer& viewer, Cursor& cursor) const {
  cursor.told_s = now_s_;
  viewer.say(text_of({{"type", "replay"},
                      {"tick", cursor.tick},
                      {"playing", cursor.playing},
                      {"speed", cursor.speed}}));
}

SharedBytes ReplayFeed::frame_at(const Cursor& cursor, const std::vector<PartId>& parts) const {
  std::vector<PartState> states;
  for (const PartId part : parts) {
    states.push_back(recording_.state_at(part, cursor.tick));
    const auto bits = cursor.classes.find(part);
    states.back().classes = bits == cursor.classes.end() ? 0u : bits->second;
  }
  return std::make_shared<const std::string>(pose_frame(cursor.tick, states));
}

SharedBytes ReplayFeed::frame(const Viewer& viewer, const std::vector<PartId>& parts) const {
  return frame_at(cursors_.find(&viewer)->second, parts);
}

MeshAnswer ReplayFeed::mesh(const std::string& hash) const {
  const auto found = recording_.meshes.find(hash);
  if (found == recording_.meshes.end()) return {};
  return {MeshAnswer::State::kHere, found->second};
}

Json ReplayFeed::statistics() const {
  return {{"mode", "replay"},
          {"session", recording_.session},
          {"parts", recording_.part_lists.back().parts.size()},
          {"meshes", recording_.meshes.size()},
          {"events", recording_.events.size()},
          {"last_tick", recording_.last_tick},
          {"pages", cursors_.size()}};
}

}  // namespace mortise::web
