#include "client/bot/crew.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "common/io/progress_log.h"
#include "common/math/interval.h"
#include "idl/dds_channel.h"

namespace mortise {
namespace {

using SteadyClock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

// An observer measures no latency: one look for the news of several ticks.
constexpr double kObserverPause_s = 0.010;
constexpr double kGoodbye_s = 0.2;  // for leave messages to go out

std::atomic<bool> stop_asked{false};

double seconds_since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

}  // namespace

void ask_to_stop(int) { stop_asked = true; }
bool stop_is_asked() { return stop_asked; }

Crew::Crew(const BotOptions& options, ClientChannel& channel, std::optional<Play> play)
    : options_(options), client_(channel), play_(std::move(play)) {
  name_users();
}

int Crew::run(ProcessReport& report) {
  add_users_due(0.0);
  if (!wait_until_joined()) return kExitRuntime;
  if (!options_.quiet) {
    log_info("{} joined session '{}': {} parts, {:g} Hz, policy {}", names_.front(),
             client_.session(), client_.parts().size(), client_.tick_rate_hz(), client_.policy());
  }
  if (!options_.for_people || wait_for_people()) {
    listen(options_.delay_s);
    if (Status found = find_parts(); !found) {
      log_error("{}", found.error().text);
      return exit_code_of(found.error().code);
    }
    act();
    release_all();
    listen(options_.linger_s);
  }
  report.document = document();
  report.latency_ms = tally_.latency_ms();
  report.event_latency_ms = tally_.event_latency_ms();
  report.stream_blocks = tally_.stream().blocks();
  for (LocalUser user = 0; user < client_.user_count(); ++user) client_.leave(user);
  stop_asked = false;
  listen(kGoodbye_s);
  return kExitOk;
}

void Crew::name_users() {
  names_ = options_.names;
  if (names_.empty() && options_.behaviour == "script" && play_) names_ = play_->users();
  for (int i = static_cast<int>(names_.size()); i < options_.users; ++i) {
    names_.push_back((options_.observer ? "observer" : "bot") + std::to_string(options_.seed) +
                     "-" + std::to_string(i + 1));
  }
}

// At time 0 at least one; all of them when there is no ramp.
void Crew::add_users_due(double now_s) {
  const auto all = static_cast<double>(names_.size());
  while (client_.user_count() < names_.size()) {
    const auto next = static_cast<double>(client_.user_count());
    if (now_s < options_.ramp_s * next / all) return;
    client_.add_user(names_[client_.user_count()], options_.observer ? "observer" : "bot");
  }
}

bool Crew::wait_until_joined() {
  const auto start = SteadyClock::now();
  const auto any = [&](JoinState state) {
    for (LocalUser user = 0; user < client_.user_count(); ++user) {
      if (client_.join_state(user) == state) return true;
    }
    return false;
  };
  while (any(JoinState::kJoining) || any(JoinState::kRefused) || !client_.synced()) {
    if (stop_asked) {
      log_error("stopped before all users had joined: nothing was done");
      return false;
    }
    if (any(JoinState::kRefused) || seconds_since(start) > options_.wait_s) {
      say_why_not_joined();
      return false;
    }
    poll(kInfinity);
  }
  return true;
}

bool Crew::wait_for_people() {
  const auto is_person = [](const UserInfo& user) {
    return user.present && user.role == Role::kDesigner;
  };
  while (!stop_asked && std::ranges::none_of(client_.users(), is_person)) poll(kInfinity);
  return !stop_asked;
}

void Crew::say_why_not_joined() const {
  for (LocalUser user = 0; user < client_.user_count(); ++user) {
    if (client_.join_state(user) == JoinState::kRefused) {
      log_error("{} was refused: {}", names_[user], client_.refusal_text(user));
      return;
    }
  }
  log_error(
      "no server of session '{}' answered on domain {} at {} within {:g} s; start mortise-server "
      "first, or wait longer with --wait",
      options_.network.session, options_.network.domain, looked_at(options_.network),
      options_.wait_s);
}

Status Crew::find_parts() {
  guided_ = options_.guided;
  if (options_.observer) return ok();
  const auto find = [&](const std::string& name, PartId& part) {
    part = client_.find_part(name);
    return name.empty() || part;
  };
  const std::string& missing = find(options_.part, part_) ? options_.target : options_.part;
  if ((options_.part.empty() || part_) && find(options_.target, guided_.target)) return ok();
  return fail(Code::kNotFound, "no part '" + missing + "' in the session");
}

void Crew::poll(double wait_s) {
  const ClientUpdate update = client_.poll();
  tally_.add(update, client_);
  if (update.pulse) {
    for (const std::string& line :
         waiting_.after_pulse(*update.pulse, client_.parts(), client_.tick_rate_hz()))
      log_info("{}", line);
  }
  client_.await_news(wait_s);
}

void Crew::listen(double seconds) {
  const auto start = SteadyClock::now();
  for (double left_s = seconds; !stop_asked && left_s > 0.0;
       left_s = seconds - seconds_since(start))
    poll(left_s);
}

void Crew::act() {
  const auto start = SteadyClock::now();
  const double beat_s = 1.0 / options_.rate_hz;
  double last_s = 0.0, next_s = 0.0;
  while (!stop_asked) {
    const double now_s = seconds_since(start);
    if (options_.duration_s > 0.0 && now_s >= options_.duration_s) break;
    add_users_due(now_s);
    if (options_.observer) {
      poll(0.0);
      std::this_thread::sleep_for(std::chrono::duration<double>(kObserverPause_s));
      continue;
    }
    if (now_s >= next_s) {
      const bool all_done = beat(now_s, now_s - last_s);
      last_s = now_s;
      next_s = std::max(next_s + beat_s, now_s);
      if (all_done) break;
    }
    const double until_next_s = next_s - seconds_since(start);
    poll(std::max(until_next_s, 0.0));
  }
  acted_s_ = seconds_since(start);
}

bool Crew::beat(double now_s, double beat_s) {
  bool all_done = client_.user_count() == names_.size();
  for (LocalUser user = 0; user < client_.user_count(); ++user) {
    if (user >= behaviours_.size()) {
      behaviours_.push_back(
          make_behaviour({options_.behaviour, names_[user], options_.first_part + user,
                          options_.seed, part_, play_ ? &*play_ : nullptr, guided_}));
      sent_seq_.push_back(0);
    }
    if (options_.ramp_s > 0.0 && client_.join_state(user) != JoinState::kJoined) {
      all_done = false;  // on the way in
      continue;
    }
    View view;
    view.time_s = now_s;
    view.beat_s = beat_s;
    view.self = client_.user_id(user);
    view.parts = &client_.parts();
    view.clashes = &client_.open_clashes();
    view.standing = &client_.standing();
    view.features = &client_.features();
    const Wish wish = behaviours_[user]->beat(view);
    all_done = all_done && wish.done;
    carry_out(user, wish);
  }
  return all_done;
}

void Crew::carry_out(LocalUser user, const Wish& wish) {
  if (wish.grab) sent_command(client_.grab(user, wish.grab));
  const bool moves = !wish.translation_mm.isZero(0.0) || !wish.rotation_rad.isZero(0.0);
  if (wish.move && moves) {
    const std::uint64_t seq = client_.send(user, wish.move, wish.translation_mm, wish.rotation_rad);
    if (seq != 0) sent_seq_[user] = seq;
  }
  for (const Wish::Ask& ask : wish.asks)
    sent_command(client_.command(user, ask.kind, ask.part, ask.details));
  if (wish.release) sent_command(client_.release(user, wish.release));
}

void Crew::release_all() {
  for (LocalUser user = 0; user < client_.user_count(); ++user) {
    for (const auto& [id, part] : client_.parts()) {
      if (client_.user_id(user) && part.info.holder == client_.user_id(user)) {
        sent_command(client_.release(user, id));
      }
    }
  }
}

Json Crew::document() const {
  const ClientStatistics s = client_.statistics();
  std::uint64_t unacknowledged = 0;
  for (LocalUser user = 0; user < sent_seq_.size(); ++user) {
    const auto& acknowledged = tally_.acknowledged();
    const std::uint64_t up_to = user < acknowledged.size() ? acknowledged[user] : 0;
    unacknowledged += sent_seq_[user] - std::min(sent_seq_[user], up_to);
  }
  Json json;
  json["session"] = client_.session();
  json["names"] = names_;
  json["role"] = options_.observer ? "observer" : "bot";
  json["behaviour"] = options_.observer ? "observe" : options_.behaviour;
  json["seed"] = options_.seed;
  json["seconds"] = acted_s_;
  json["sent"] = s.increments_sent;
  json["not_sent"] = s.not_joined;
  json["unacknowledged_increments"] = unacknowledged;
  json["commands_sent"] = commands_sent_;
  json["unanswered_commands"] = commands_sent_ - std::min(commands_sent_, tally_.replies());
  // Known of from the pose stream, but neither come nor covered by a snapshot by now.
  json["lost"] = {{"events", s.known_event_seq - s.highest_event_seq},
                  {"pose_batches", s.poses_missed},
                  {"event_gaps", s.gaps},
                  {"increments_given_up", s.increments_given_up}};
  json["repaired"] = {{"resyncs", s.snapshots_applied > 0 ? s.snapshots_applied - 1 : 0},
                      {"events_by_snapshot", s.events_skipped},
                      {"snapshots_requested", s.snapshots_requested},
                      {"increments_repeated", s.increments_repeated}};
  json.update(tally_.json());
  json["last_tick"] = s.highest_tick;
  json["state"] = state_json(client_);
  json["troubles"] = Json::array();
  for (const auto& behaviour : behaviours_) {
    for (const std::string& trouble : behaviour->troubles()) json["troubles"].push_back(trouble);
  }
  if (const Json insertions = insertions_json(behaviours_); !insertions.is_null()) {
    json["insertions"] = insertions;
  }
  return json;
}

}  // namespace mortise
