#include "client/web/page_seats.h"

#include <algorithm>
#include <chrono>

#include "common/messages/names.h"

namespace mortise::web {
namespace {

// The server takes a name for free one tick after its user left; a page that is loaded anew may be
// back by then.
constexpr double kNameIsFreeAfter_s = 2.0;
constexpr double kRejoinEvery_s = 0.1;
constexpr double kRefusalsEvery_s = 0.1;
constexpr std::size_t kMostOpenCommands = 1024;

Json reply_json(std::uint64_t id, Refusal refusal, const std::string& text, PartId part,
                UserId holder) {
  return {{"type", "reply"},
          {"id", id},
          {"done", refusal == Refusal::kNone},
          {"refusal", name_of(refusal)},
          {"text", text},
          {"part", part.value},
          {"holder", holder.value}};
}

SharedBytes joined_text(UserId user, const std::string& name, Role role) {
  return text_of(
      {{"type", "joined"}, {"user", user.value}, {"name", name}, {"role", name_of(role)}});
}

double unix_ms() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration<double, std::milli>(now).count();
}

}  // namespace

void PageSeats::leave(Viewer& viewer) {
  const auto found = seats_.find(&viewer);
  if (found == seats_.end()) return;
  uploads_.leave(viewer);
  if (found->second.user) go(*found->second.user, found->second.name);
  seats_.erase(found);
}

void PageSeats::go(LocalUser user, const std::string& name) {
  client_.leave(user);
  left_s_[name] = now_s_;
}

void PageSeats::lose(Viewer& viewer) {
  const auto found = seats_.find(&viewer);
  if (found == seats_.end()) return;
  set_aside(viewer, found->second);
  leave(viewer);
}

void PageSeats::set_aside(const Viewer& viewer, Seat& seat) {
  if (seat.user && away_.keep({*seat.user, seat.name, seat.page, viewer.role()})) seat.user.reset();
}

// A page that is back, perhaps before its old line was found to be broken.
bool PageSeats::take_up(Viewer& viewer, Seat& seat) {
  if (seat.page.empty()) return false;
  for (auto& [other, old] : seats_) {
    if (other == &viewer || old.page != seat.page) continue;
    set_aside(*other, old);
    if (old.user) go(*old.user, old.name);
    old = Seat();
  }
  seat.user = away_.take_up({0, seat.name, seat.page, viewer.role()});
  if (seat.user && client_.join_state(*seat.user) == JoinState::kJoined)
    viewer.say(joined_text(client_.user_id(*seat.user), seat.name, viewer.role()));
  return seat.user.has_value();
}

// A name belongs to who is here: to another page of the same person, say.
void PageSeats::end_away(const std::string& name) {
  for (const auto& away : away_.take_ended([&](const auto& one) { return one.name == name; }))
    go(away.user, away.name);
}

Status PageSeats::take(Viewer& viewer, const PageMessage& message) {
  Seat& seat = seats_.at(&viewer);
  if (const auto* wish = std::get_if<JoinWish>(&message)) {
    if (seat.user || seat.rejoin_s > 0.0)
      return fail(Code::kInvalidInput, "you have joined as " + seat.name);
    join(viewer, seat, *wish);
  } else if (const auto* increment = std::get_if<MoveWish>(&message)) {
    if (!seat.user) return fail(Code::kInvalidInput, "join before you move parts");
    move(viewer, seat, *increment);
  } else if (const auto* asked = std::get_if<CommandWish>(&message)) {
    command(viewer, seat, *asked);
  } else if (const auto* file = std::get_if<UploadWish>(&message)) {
    upload(viewer, seat, *file);
  } else if (const auto* view = std::get_if<ViewWish>(&message)) {
    seat.view =
        Json{{"p", json_of(view->p)}, {"target", json_of(view->target)}, {"up", json_of(view->up)}};
  } else if (const auto* ping = std::get_if<PingWish>(&message)) {
    viewer.say(text_of({{"type", "pong"}, {"at", ping->at}}));
  } else {
    return fail(Code::kInvalidInput, "this is a live session: there is nothing to replay");
  }
  return ok();
}

void PageSeats::join(Viewer& viewer, Seat& seat, const JoinWish& wish) {
  if (const std::string& bound = viewer.bound_name(); !bound.empty() && bound != wish.name) {
    ++foreign_names_;
    const std::string text = "this link is " + bound + "'s: join as " + bound;
    return viewer.say(text_of({{"type", "join_refused"}, {"text", text}}));
  }
  seat.name = wish.name;
  seat.page = wish.page;
  if (take_up(viewer, seat)) return;
  end_away(seat.name);
  seat.user = client_.add_user(wish.name, std::string(name_of(viewer.role())));
  const auto left = left_s_.find(wish.name);
  if (left != left_s_.end()) seat.give_up_s = left->second + kNameIsFreeAfter_s;
}

void PageSeats::move(Viewer& viewer, Seat& seat, const MoveWish& wish) {
  if (viewer.role() == Role::kObserver) {
    ++seat.refused[{wish.part, Refusal::kObserver}];
  } else if (client_.send(*seat.user, wish.part, wish.translation_mm, wish.rotation_rad) == 0) {
    ++seat.refused[{wish.part, Refusal::kUnknownUser}];
  }
}

void PageSeats::refuse(Viewer& viewer, const CommandWish& wish, Refusal refusal,
                       const std::string& text) {
  viewer.say(text_of(reply_json(wish.id, refusal, text, wish.part, UserId{})));
}

void PageSeats::command(Viewer& viewer, Seat& seat, const CommandWish& wish) {
  if (viewer.role() == Role::kObserver)
    return refuse(viewer, wish, Refusal::kObserver, "this link is for looking on");
  if (!seat.user) return refuse(viewer, wish, Refusal::kUnknownUser, "join first");
  if (seat.asked.size() >= kMostOpenCommands)
    return refuse(viewer, wish, Refusal::kRateTooHigh, "too many commands wait for an answer");
  const std::uint64_t seq = client_.command(*seat.user, wish.kind, wish.part, wish.details);
  if (seq == 0)
    return refuse(viewer, wish, Refusal::kUnknownUser, "not in the session yet, or not any more");
  seat.asked[seq] = wish.id;
}

void PageSeats::upload(Viewer& viewer, Seat& seat, const UploadWish& wish) {
  if (viewer.role() == Role::kObserver)
    return PageUploads::refuse(viewer, wish.id, Refusal::kObserver, "this link is for looking on");
  if (!seat.user || client_.join_state(*seat.user) != JoinState::kJoined)
    return PageUploads::refuse(viewer, wish.id, Refusal::kUnknownUser, "join first");
  uploads_.ask(viewer, *seat.user, wish, now_s_);
}

void PageSeats::begin_turn(double now_s) {
  now_s_ = now_s;
  uploads_.turn(now_s);
  end_away("");
  std::erase_if(left_s_, [&](const auto& row) { return now_s - row.second > kNameIsFreeAfter_s; });
}

void PageSeats::end_turn(const ClientUpdate& update) {
  tell_refusals();
  tell_pulse(update);
  tell_views();
}

void PageSeats::tell_all(const Json& json) {
  if (seats_.empty()) return;
  const SharedBytes text = text_of(json);
  for (auto& [viewer, seat] : seats_) viewer->say(text);
}

void PageSeats::forget_answers() {
  for (auto& [viewer, seat] : seats_) {
    for (const auto& [seq, id] : seat.asked) {
      viewer->say(
          text_of(reply_json(id, Refusal::kUnknownUser, "the server went away before it answered",
                             PartId{}, UserId{})));
    }
    seat.asked.clear();
  }
}

PageSeats::Row* PageSeats::seat_of(LocalUser user) {
  const auto found = std::find_if(seats_.begin(), seats_.end(),
                                  [&](const auto& row) { return row.second.user == user; });
  return found == seats_.end() ? nullptr : &*found;
}

PageSeats::Row* PageSeats::seat_of(UserId user) {
  const auto found = std::find_if(seats_.begin(), seats_.end(), [&](const auto& row) {
    return row.second.user && client_.user_id(*row.second.user) == user;
  });
  return found == seats_.end() ? nullptr : &*found;
}

void PageSeats::tell_joins(const ClientUpdate& update) {
  for (const LocalUser user : update.joined) {
    auto* row = seat_of(user);
    if (row == nullptr) continue;
    row->first->say(joined_text(client_.user_id(user), row->second.name, row->first->role()));
  }
  for (auto& [viewer, seat] : seats_) {
    if (seat.rejoin_s > 0.0 && now_s_ >= seat.rejoin_s) {
      seat.rejoin_s = 0.0;
      seat.user = client_.add_user(seat.name, std::string(name_of(viewer->role())));
    }
    if (!seat.user || client_.join_state(*seat.user) != JoinState::kRefused) continue;
    const std::string text = client_.refusal_text(*seat.user);
    client_.leave(*seat.user);
    seat.user.reset();
    if (now_s_ < seat.give_up_s) {
      seat.rejoin_s = now_s_ + kRejoinEvery_s;
      continue;
    }
    viewer->say(text_of({{"type", "join_refused"}, {"text", text}}));
  }
}

void PageSeats::tell_replies(const ClientUpdate& update) {
  uploads_.tell(update.uploads);
  for (const Reply& reply : update.replies) {
    auto* row = seat_of(reply.user);
    if (row == nullptr) continue;
    const auto asked = row->second.asked.find(reply.seq);
    if (asked == row->second.asked.end()) continue;
    row->first->say(
        text_of(reply_json(asked->second, reply.refusal, reply.text, reply.part, reply.holder)));
    row->second.asked.erase(asked);
  }
  for (const RefusedIncrement& refused : update.refused) {
    if (auto* row = seat_of(refused.user)) ++row->second.refused[{refused.part, refused.reason}];
  }
  for (const SeenAck& ack : update.acks) {
    auto* row = seat_of(ack.user);
    if (row == nullptr || ack.sent_ns == 0) continue;
    row->second.latency_ms.push_back(static_cast<double>(update.at_ns - ack.sent_ns) * 1e-6);
  }
}

void PageSeats::tell_refusals() {
  for (auto& [viewer, seat] : seats_) {
    if (seat.refused.empty() || now_s_ - seat.refused_said_s < kRefusalsEvery_s) continue;
    seat.refused_said_s = now_s_;
    Json json{{"type", "refused"}, {"increments", Json::array()}};
    for (const auto& [what, count] : seat.refused) {
      json["increments"].push_back(
          {{"part", what.first.value}, {"reason", name_of(what.second)}, {"count", count}});
    }
    seat.refused.clear();
    viewer->say(text_of(json));
  }
}

void PageSeats::tell_pulse(const ClientUpdate& update) {
  if (!update.pulse) return;
  Json json = json_of(*update.pulse);
  for (auto& [viewer, seat] : seats_) {
    json["latency_ms"] = percentiles_of(std::move(seat.latency_ms));
    seat.latency_ms.clear();
    json["gateway"] = {{"browsers", seats_.size()},
                       {"poses_folded", viewer->folded_frames()},
                       {"clock_ms", unix_ms()}};
    viewer->say(text_of(json));
  }
}

void PageSeats::tell_views() {
  if (now_s_ - views_said_s_ < 1.0 / limits_.views_per_s) return;
  views_said_s_ = now_s_;
  Json all = Json::array();
  std::vector<const Viewer*> whose;
  for (auto& [viewer, seat] : seats_) {
    if (!seat.view || !seat.user || !client_.user_id(*seat.user)) continue;
    Json view{{"user", client_.user_id(*seat.user).value}};
    view.update(*seat.view);
    seat.view.reset();
    all.push_back(std::move(view));
    whose.push_back(viewer);
  }
  if (all.empty()) return;
  const SharedBytes text = text_of({{"type", "views"}, {"views", all}});
  for (auto& [viewer, seat] : seats_) {
    if (whose.size() == 1 && whose.front() == viewer) continue;
    viewer->say_views(text);
  }
}

}  // namespace mortise::web
