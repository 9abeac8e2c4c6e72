#include "client/bot/bot.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>

#include "client/bot/behaviour.h"
#include "client/bot/tally.h"
#include "client/client.h"
#include "common/io/play_file.h"
#include "idl/dds_channel.h"

namespace mortise {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr auto kPollEvery = std::chrono::milliseconds(2);  // what latency figures are rounded up to
constexpr auto kObserverPollEvery = std::chrono::milliseconds(10);
constexpr double kGoodbye_s = 0.2;  // for leave messages to go out

std::atomic<bool> stop_asked{false};
void ask_to_stop(int) { stop_asked = true; }

double seconds_since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

/// One process with its logical users.
class Bot {
 public:
  Bot(const BotOptions& options, ClientChannel& channel, std::optional<Play> play)
      : options_(options), channel_(channel), client_(channel), play_(std::move(play)) {}

  int run() {
    add_users();
    if (!wait_until_joined()) return kExitRuntime;
    if (!options_.quiet) {
      spdlog::info("{} joined session '{}': {} parts, {:g} Hz, policy {}", names_.front(),
                   client_.session(), client_.parts().size(), client_.tick_rate_hz(),
                   client_.policy());
    }
    listen(options_.delay_s);
    if (Status made = make_behaviours(); !made) {
      spdlog::error("{}", made.error().text);
      return exit_code_of(made.error().code);
    }
    act();
    release_all();
    listen(options_.linger_s);
    const int exit_code = report();
    for (LocalUser user = 0; user < names_.size(); ++user) client_.leave(user);
    stop_asked = false;
    listen(kGoodbye_s);
    return exit_code;
  }

 private:
  void add_users() {
    names_ = options_.names;
    if (names_.empty() && options_.behaviour == "script" && play_) names_ = play_->users();
    for (int i = static_cast<int>(names_.size()); i < options_.users; ++i) {
      names_.push_back((options_.observer ? "observer" : "bot") + std::to_string(options_.seed) +
                       "-" + std::to_string(i + 1));
    }
    for (const std::string& name : names_) {
      client_.add_user(name, options_.observer ? "observer" : "bot");
    }
  }

  bool all_joined() const {
    for (LocalUser user = 0; user < names_.size(); ++user) {
      if (client_.join_state(user) != JoinState::kJoined) return false;
    }
    return client_.synced();
  }

  bool any_refused() const {
    for (LocalUser user = 0; user < names_.size(); ++user) {
      if (client_.join_state(user) == JoinState::kRefused) return true;
    }
    return false;
  }

  bool wait_until_joined() {
    const auto start = SteadyClock::now();
    while (!all_joined()) {
      if (stop_asked) return false;
      if (any_refused() || seconds_since(start) > options_.wait_s) {
        say_why_not_joined();
        return false;
      }
      poll(kPollEvery);
    }
    return true;
  }

  void say_why_not_joined() const {
    for (LocalUser user = 0; user < names_.size(); ++user) {
      if (client_.join_state(user) == JoinState::kRefused) {
        spdlog::error("{} was refused: {}", names_[user], client_.refusal_text(user));
        return;
      }
    }
    spdlog::error(
        "no server of session '{}' answered on domain {} at {} within {:g} s; start "
        "mortise-server first, or wait longer with --wait",
        options_.session, options_.domain,
        options_.server.empty() ? options_.interface : options_.server, options_.wait_s);
  }

  Status make_behaviours() {
    if (options_.observer) return ok();
    PartId part;
    if (!options_.part.empty()) {
      part = client_.find_part(options_.part);
      if (!part) {
        return fail(Code::kNotFound, "no part '" + options_.part + "' in the session");
      }
    }
    for (std::size_t i = 0; i < names_.size(); ++i) {
      behaviours_.push_back(make_behaviour(
          {options_.behaviour, names_[i], i, options_.seed, part, play_ ? &*play_ : nullptr}));
    }
    return ok();
  }

  void poll(std::chrono::milliseconds pause) {
    tally_.add(client_.poll(), client_);
    std::this_thread::sleep_for(pause);
  }

  void listen(double seconds) {
    const auto start = SteadyClock::now();
    while (!stop_asked && seconds_since(start) < seconds) poll(kPollEvery);
  }

  void act() {
    const auto start = SteadyClock::now();
    const double beat_s = 1.0 / options_.rate_hz;
    double last_s = 0.0, next_s = 0.0;
    while (!stop_asked) {
      const double now_s = seconds_since(start);
      if (options_.duration_s > 0.0 && now_s >= options_.duration_s) break;
      if (options_.observer) {
        poll(kObserverPollEvery);
        continue;
      }
      if (now_s >= next_s) {
        const bool all_done = beat(now_s, now_s - last_s);
        last_s = now_s;
        next_s = std::max(next_s + beat_s, now_s);
        if (all_done) break;
      }
      const double until_next_s = next_s - seconds_since(start);
      poll(std::min(kPollEvery, std::chrono::milliseconds(
                                    static_cast<int>(std::max(until_next_s * 1e3, 0.0)) + 1)));
    }
    acted_s_ = seconds_since(start);
  }

  /// One beat of all users; true when none has anything left to do.
  bool beat(double now_s, double beat_s) {
    bool all_done = true;
    for (LocalUser user = 0; user < behaviours_.size(); ++user) {
      View view;
      view.time_s = now_s;
      view.beat_s = beat_s;
      view.self = client_.user_id(user);
      view.parts = &client_.parts();
      const Wish wish = behaviours_[user]->beat(view);
      all_done = all_done && wish.done;
      if (wish.grab) client_.grab(user, wish.grab);
      const bool moves = !wish.translation_mm.isZero(0.0) || !wish.rotation_rad.isZero(0.0);
      if (wish.move && moves) {
        client_.send(user, wish.move, wish.translation_mm, wish.rotation_rad);
      }
      if (wish.release) client_.release(user, wish.release);
    }
    return all_done;
  }

  void release_all() {
    for (LocalUser user = 0; user < names_.size(); ++user) {
      for (const auto& [id, part] : client_.parts()) {
        if (client_.user_id(user) && part.info.holder == client_.user_id(user)) {
          client_.release(user, id);
        }
      }
    }
  }

  int report() const {
    const ClientStatistics& s = client_.statistics();
    nlohmann::ordered_json json;
    json["session"] = client_.session();
    json["names"] = names_;
    json["role"] = options_.observer ? "observer" : "bot";
    json["behaviour"] = options_.observer ? "observe" : options_.behaviour;
    json["seed"] = options_.seed;
    json["seconds"] = acted_s_;
    json["sent"] = s.increments_sent;
    json["not_sent"] = s.not_joined;
    json["repeated"] = s.increments_repeated;
    json["given_up"] = s.increments_given_up;
    json["lost"] = {{"pose_batches", s.poses_missed},
                    {"event_gaps", s.gaps},
                    {"events_by_snapshot", s.events_skipped}};
    json.update(tally_.json());
    json["last_tick"] = s.highest_tick;
    json["state"] = state_json(client_);
    json["troubles"] = nlohmann::ordered_json::array();
    for (const auto& behaviour : behaviours_) {
      for (const std::string& trouble : behaviour->troubles()) json["troubles"].push_back(trouble);
    }
    if (options_.json) {
      std::cout << json.dump(2) << std::endl;
    } else {
      print(json);
    }
    const double p99_ms = tally_.latency_percentile_ms(0.99);
    if (options_.max_p99_ms > 0.0 && p99_ms > options_.max_p99_ms) {
      spdlog::error("latency p99 {:.2f} ms is above the limit of {:g} ms", p99_ms,
                    options_.max_p99_ms);
      return kExitThreshold;
    }
    return kExitOk;
  }

  void print(const nlohmann::ordered_json& json) const {
    const auto& latency = json["latency_ms"];
    const auto& events = json["events"];
    const auto& seen = json["clashes_seen"];
    std::string names;
    for (const std::string& name : names_) names += (names.empty() ? "" : ", ") + name;
    std::cout << fmt::format(
        "{} ({}, {:.1f} s)\n"
        "  increments   sent {}, refused {}, commands refused {}\n"
        "  latency      p50 {:.2f} ms, p90 {:.2f}, p99 {:.2f}, max {:.2f} (send to ack)\n"
        "  lost         pose batches {}, event gaps {}\n"
        "  clashes seen real {}, potential {}, fake {}; {} events, hash {}\n"
        "  at the end   poses {}, {} open clashes {}\n",
        names, json["behaviour"].get<std::string>(), acted_s_, json["sent"].get<std::uint64_t>(),
        tally_.refused(), json["commands_refused"].get<std::uint64_t>(),
        latency["p50"].get<double>(), latency["p90"].get<double>(), latency["p99"].get<double>(),
        latency["max"].get<double>(), json["lost"]["pose_batches"].get<std::uint64_t>(),
        json["lost"]["event_gaps"].get<std::uint64_t>(), seen["real"].get<std::uint64_t>(),
        seen["potential"].get<std::uint64_t>(), seen["fake"].get<std::uint64_t>(),
        events["count"].get<std::uint64_t>(), events["hash"].get<std::string>(),
        json["state"]["pose_hash"].get<std::string>(), client_.open_clashes().size(),
        json["state"]["clash_hash"].get<std::string>());
    for (const auto& trouble : json["troubles"]) {
      std::cout << "  not done     " << trouble.get<std::string>() << "\n";
    }
    std::cout << std::flush;
  }

  BotOptions options_;
  ClientChannel& channel_;
  Client client_;
  std::optional<Play> play_;
  std::vector<std::string> names_;
  std::vector<std::unique_ptr<Behaviour>> behaviours_;
  Tally tally_;
  double acted_s_ = 0.0;
};

}  // namespace

int run_bot(const BotOptions& options) {
  std::optional<Play> play;
  if (options.behaviour == "script" && !options.observer) {
    auto read = read_play(options.play);
    if (!read) {
      spdlog::error("{}", read.error().text);
      return exit_code_of(read.error().code);
    }
    play = std::move(*read);
  }
  DdsOptions dds;
  dds.session = options.session;
  dds.domain = options.domain;
  dds.interface = options.interface;
  dds.server = options.server;
  dds.discovery_port = options.port;
  dds.meshes = false;  // a bot does not look at parts
  auto channel = open_client_channel(dds);
  if (!channel) {
    spdlog::error("{}", channel.error().text);
    return exit_code_of(channel.error().code);
  }
  std::signal(SIGINT, ask_to_stop);
  std::signal(SIGTERM, ask_to_stop);
  return Bot(options, **channel, std::move(play)).run();
}

}  // namespace mortise
