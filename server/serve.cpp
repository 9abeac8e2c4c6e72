#include "server/serve.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <ctime>
#include <deque>
#include <fstream>
#include <iostream>
#include <optional>
#include <random>

#include "common/base/json_text.h"
#include "common/io/progress_log.h"
#include "common/session/world/ready_world.h"
#include "idl/dds_channel.h"
#include "server/announcer.h"
#include "server/closing.h"
#include "server/drain.h"
#include "server/etcd_fencing.h"
#include "server/held_channel.h"
#include "server/memory.h"
#include "server/metrics_endpoint.h"
#include "server/restore.h"
#include "server/scheduling.h"
#include "server/service_manager.h"
#include "server/standby.h"
#include "server/start.h"

namespace mortise {
namespace {

constexpr double kShowFiguresEvery_s = 1.0;  // collectors come each few seconds
constexpr double kSayAhead_s = 2.0;          // less is a restart within a moment

std::atomic<bool> stop_asked{false}, drain_asked{false};  // lock-free: set in signal handlers

void ask_to_stop(int) { stop_asked = true; }
void ask_to_drain(int) { drain_asked = true; }

// Of one server among all that ever lead a session.
std::string random_name() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}{:08x}", random(), random(), random());
}

int say(const Error& error) {
  log_error("{}", error.text);
  return exit_code_of(error.code);
}

/// Plays the log of before again, when there is one.
Result<std::optional<Resumed>> resume(SessionStart& start, const ServerOptions& options) {
  std::optional<Resumed> resumed;
  if (!start.log) return resumed;
  const auto begun = std::chrono::steady_clock::now();
  const std::uint64_t from_tick = start.scene.world.tick;
  auto played = resume_from(*start.log, start.scene.world, options.threads,
                            options.standby_of.empty(), [] { return stop_asked || drain_asked; });
  if (!played) return fail(played.error().code, start.source + ": " + played.error().text);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  log_info("restored from {}: {} ticks{}; {} played again in {:.2f} s, each as it was logged",
           start.source, played->ticks,
           from_tick > 0 ? fmt::format(", the state after tick {} from a checkpoint", from_tick)
                         : std::string(),
           played->ticks_computed, took.count());
  if (const int begun_for = start.scene.world.threads; begun_for != options.threads)
    log_info("ticks keep work for {} thread(s), as the session began with; --threads {} plays them",
             begun_for, options.threads);
  if (played->ticks_left_out > 0) {
    log_warning("{} ticks of {} are left out: {}", played->ticks_left_out, start.source,
                played->left_out_because);
  }
  // The log of a server that still leads is never closed.
  if (options.standby_of.empty() && !played->missing_at_end.empty())
    log_warning("{}: {}", start.source, played->missing_at_end);
  start.log.reset();
  resumed = std::move(*played);
  return resumed;
}

int close_session(const ServerOptions& options, Closing closing, SessionLogWriter* log,
                  const TickLoop& loop) {
  int exit_code = kExitOk;
  if (log != nullptr) {
    if (Status status = log->close(); !status) {
      closing.log_error = status.error().text;
      exit_code = say(status.error());
    }
    closing.log_bytes = log->bytes_written();
    closing.log_dropped_ticks = log->dropped_ticks();
  }
  if (options.json) {
    std::cout << json_text(closing_json(closing, loop)) << std::endl;
  } else {
    std::cout << closing_table(closing, loop) << std::flush;
  }
  if (!options.stats.empty()) {
    std::ofstream out(options.stats);
    out << json_text(closing_json(closing, loop)) << "\n";
    if (!out.flush()) {
      log_error("{}: cannot be written", options.stats);
      exit_code = kExitRuntime;
    }
  }
  return exit_code;
}

/// A server from its start to its end, in steps.
class Service {
 public:
  Service(const ServerOptions& options, Console* console) : options_(options), console_(console) {}
  /// 1 to 5. False: it was to end before it led a session.
  Result<bool> begin();
  /// 6. Ticks until it is to end.
  void play();
  /// 7. Returns the exit code.
  int end();

 private:
  bool stands_by() const { return !options_.standby_of.empty(); }
  // One that stands by has nothing to hand over.
  static bool is_to_stop() { return stop_asked || drain_asked; }
  bool beats_until_stop() {
    manager_.beat();
    return is_to_stop();
  }
  std::int64_t term_ns() const {
    return static_cast<std::int64_t>(channel_->term_ms() * 1'000'000);
  }
  std::string barred() const {
    const std::string by_etcd = fencing_ ? fencing_->barred() : std::string();
    return by_etcd.empty() ? channel_->barred() : by_etcd;
  }
  Status open_fencing(ClientKey own);

  Result<bool> find_leader();
  Status open_channel();
  Status open_log();
  Result<bool> follow_leader();
  void open_loop();
  Status open_metrics();
  void say_session() const;
  void after_tick(Announcer& announcer);
  void say_goodbye();

  const ServerOptions& options_;
  Console* console_;
  ServiceManager manager_;
  std::optional<SessionStart> start_;
  std::unique_ptr<StandbyChannel> standby_;  ///< until it is the channel
  std::deque<ToldTick> told_;                ///< by the leader, while the log was not read yet
  std::unique_ptr<ServerChannel> channel_;
  std::optional<Resumed> resumed_;
  NewLog log_;
  Closing closing_;
  std::vector<SeatRecord> seats_;         ///< of the server that was followed
  std::int64_t followed_ns_ = 0;          ///< wall clock of its last tick
  std::unique_ptr<EtcdFencing> fencing_;  ///< null: the site names no etcd
  std::optional<SystemClock> clock_;
  std::optional<HeldChannel> held_;
  std::optional<TickLoop> loop_;
  std::optional<Drain> drain_;
  std::unique_ptr<MetricsEndpoint> metrics_;
  double shown_at_s_ = -kShowFiguresEvery_s;
};

Result<bool> Service::begin() {
  if (stands_by()) {
    const Result<bool> found = find_leader();
    if (!found || !*found) return found;
  } else {
    // Before its log is read: a server that still leads may write to it.
    if (Status opened = open_fencing(random_name()); !opened) return opened.error();
    if (fencing_)
      if (Status leads = fencing_->lead([this] { return !beats_until_stop(); }); !leads)
        return leads.error();
  }
  auto start = read_start(options_);
  if (!start) return start.error();
  start_ = std::move(*start);
  make_world_ready(start_->scene.world, options_.threads);
  if (Status opened = open_channel(); !opened) return opened.error();
  if (Status opened = open_log(); !opened) {
    if (!is_to_stop()) return opened.error();
    log_info("{}", opened.error().text);
    return false;
  }
  if (stands_by()) {
    const Result<bool> leads = follow_leader();
    if (!leads || !*leads) return leads;
  }
  open_loop();
  if (Status opened = open_metrics(); !opened) return opened.error();
  manager_.ready("leading session " + options_.network.session);
  return true;
}

Status Service::open_fencing(ClientKey own) {
  if (options_.etcd.empty()) return ok();
  auto etcd = EtcdClient::open(options_.etcd);
  if (!etcd) return etcd.error();
  fencing_ =
      std::make_unique<EtcdFencing>(std::move(*etcd), options_.network.session, std::move(own));
  return ok();
}

// 1. of one that stands by: a leader, and all of its ticks of before in its log
Result<bool> Service::find_leader() {
  auto opened = open_standby_channel(options_.network);
  if (!opened) return opened.error();
  standby_ = std::move(*opened);
  if (Status fencing = open_fencing(standby_->own_key()); !fencing) return fencing.error();
  log_info("standing by: waiting for the server of session '{}'", options_.network.session);
  manager_.ready("standing by for session " + options_.network.session);
  auto found = await_leader(*standby_, told_, [this] { return beats_until_stop(); });
  manager_.busy();  // the log is read
  return found;
}

// 2. the channel
Status Service::open_channel() {
  if (stands_by()) {
    channel_ = std::move(standby_);
    return ok();
  }
  DdsOptions network = options_.network;
  network.led_until_ms = static_cast<std::uint64_t>(start_->led_until_ns / 1'000'000);
  auto opened = open_server_channel(network);
  if (!opened) return opened.error();
  channel_ = std::move(*opened);
  return ok();
}

// 3. the log of before, played again, and the new one
Status Service::open_log() {
  auto resumed = resume(*start_, options_);
  if (!resumed) return resumed.error();
  resumed_ = std::move(*resumed);
  std::optional<LogBegin> begin;
  if (resumed_) begin = std::move(resumed_->begin);
  // No log begins before the term under which it is written: the next one finds that term in it.
  if (begin) begin->time_ns = std::max(begin->time_ns, term_ns());
  auto log = create_log(options_, *start_, std::move(begin));
  if (!log) return log.error();
  log_ = std::move(*log);

  const LoadedScene& scene = start_->scene;
  closing_.session = options_.network.session;
  closing_.scenario = start_->source;
  closing_.policy = name_of(scene.world.policy);
  closing_.log_file = log_.file;
  for (std::size_t i = 0; i < scene.imports.size() && i < scene.world.parts.size(); ++i)
    if (!scene.imports[i].closed && !scene.world.parts[i].solid->has_inside())
      closing_.parts_without_inside.push_back(scene.world.parts[i].name);
  if (!resumed_) return ok();
  closing_.restored_from = start_->source;
  closing_.restored_ticks = resumed_->ticks;
  closing_.restore_left_out_ticks = resumed_->ticks_left_out;
  return ok();
}

// 4. of one that stands by: in step with the leader until it is to lead
Result<bool> Service::follow_leader() {
  (void)run_before_others();          // said in open_loop()
  if (!resumed_) resumed_.emplace();  // the leader's session has no log
  World& world = start_->scene.world;
  Follower follower(world, resumed_->statistics, log_.writer.get(), options_.threads);
  auto& line = static_cast<StandbyChannel&>(*channel_);
  auto ended = follow(
      line, std::move(told_), follower, [this] { return beats_until_stop(); },
      [](const std::string& note) { log_info("standing by: {}", note); });
  if (!ended || !*ended) return ended;
  seats_ = follower.seats();
  followed_ns_ = follower.time_ns();
  run_as_others();  // and the threads of the endpoints
  if (fencing_)
    if (Status may = fencing_->take_over([this] { return !beats_until_stop(); }); !may)
      return may.error();
  if (Status taken = line.take_over(); !taken) return taken.error();
  if (log_.writer)
    if (Status named = log_.writer->take_name(); !named) log_error("{}", named.error().text);
  log_warning("the server of session '{}' {}: taken over at tick {}, {} users",
              options_.network.session, follower.handed_over() ? "hands over" : "is gone",
              world.tick, seats_.size());
  return true;
}

// Also where a log continues: its times may be right, those of certificates are not.
void say_clock_that_is_not_set() {
  constexpr std::time_t kFirst_s = 1'577'836'800;  // 2020: no server of this kind ran before
  const std::time_t now_s = std::time(nullptr);
  if (now_s >= kFirst_s) return;
  std::tm utc{};
  gmtime_r(&now_s, &utc);
  char day[32];
  std::strftime(day, sizeof day, "%Y-%m-%d", &utc);
  log_warning(
      "the clock of this machine shows {}: times and names of the log, and the term, go by it; set "
      "the clock and start again",
      day);
}

// 5. the tick loop and what looks at it
void Service::open_loop() {
  say_clock_that_is_not_set();
  if (const Status first = run_before_others(); !first) log_info("{}", first.error().text);
  // No tick is logged before the term of its server: so the next one finds a later term in the log.
  clock_.emplace(std::max(term_ns(), followed_ns_));
  if (const double ahead_s = clock_->ahead_s(); ahead_s > kSayAhead_s)
    log_warning(
        "the clock of this machine is {:.0f} s behind the last tick of {}: the log's "
        "times go on from there",
        ahead_s, start_->source);
  TickLoopOptions options;
  options.session = options_.network.session;
  options.threads = options_.threads;
  options.inbox = options_.limits;
  held_.emplace(
      *channel_, *clock_, [this] { return loop_->inbox().users_present(); }, fencing_.get());
  loop_.emplace(start_->scene.world, *held_, *clock_, log_.writer.get(), options);
  drain_.emplace(*loop_, *held_, *clock_);
  if (resumed_ && stands_by()) {
    if (!fencing_)
      held_->await(seats_);  // where it knows that nobody else leads, nobody is missing
    loop_->adopt(std::move(resumed_->statistics), seats_);
  } else if (resumed_) {
    loop_->resume(std::move(resumed_->statistics), std::move(resumed_->departures));
  }
  loop_->open();
  say_session();
}

void Service::say_session() const {
  const World& world = start_->scene.world;
  log_info("session '{}' of {}: {} parts, {:g} Hz, policy {}, domain {} on {}",
           options_.network.session, start_->source, world.parts.size(), world.tick_rate_hz,
           closing_.policy, options_.network.domain, options_.network.interface);
  if (!closing_.log_file.empty()) log_info("log {}", closing_.log_file);
  for (const std::string& part : closing_.parts_without_inside)
    log_warning(
        "'{}' has no inside (it is open): crossing is found, depth is not, and what lies within it "
        "is not examined",
        part);
}

Status Service::open_metrics() {
  if (!options_.metrics_port) return ok();
  auto opened = MetricsEndpoint::open(options_.metrics_address, *options_.metrics_port);
  if (!opened) return opened.error();
  metrics_ = std::move(*opened);
  log_info("metrics at http://{}:{}/metrics", options_.metrics_address, metrics_->port());
  return ok();
}

void Service::play() {
  Announcer announcer({options_.live, options_.quiet, options_.addresses}, console_);
  loop_->run(
      [&] {
        return stop_asked || loop_->superseded() || !barred().empty() ||
               (drain_asked && drain_->is_ready()) ||
               (options_.duration_s > 0.0 && loop_->seconds() >= options_.duration_s);
      },
      [&] { after_tick(announcer); });
  announcer.finish();
}

void Service::after_tick(Announcer& announcer) {
  announcer.after_tick(*loop_);
  for (const std::string& note : held_->take_notes()) log_warning("{}", note);
  manager_.beat();
  if (!metrics_) return;
  metrics_->beat();
  if (loop_->seconds() - shown_at_s_ < kShowFiguresEvery_s) return;
  shown_at_s_ = loop_->seconds();
  metrics_->show(figures_of(*loop_, channel_->counters(), options_.network.session,
                            held_->follower_backlog()));
}

int Service::end() {
  manager_.ends();
  const std::string bar = barred();
  const bool was_barred = !bar.empty();
  if (drain_->begun() && !stop_asked && !loop_->superseded() && !was_barred) {
    drain_->finish([&] {
      if (metrics_) metrics_->beat();
      return !stop_asked;
    });
  }
  if (loop_->superseded()) {
    const std::string& by = loop_->superseded_by();
    log_error("another server leads session '{}' since{}; start this one with --standby-of {}",
              options_.network.session, by.empty() ? "" : ", the one at " + by,
              options_.network.session);
  } else if (was_barred) {
    log_error("{}", bar);
    // One that stands by goes on with the session, and takes nothing more from this one.
    if (!fencing_ && !held_->follower_in_step()) say_goodbye();
  } else if (drain_->end() != Drain::End::kNone) {
    log_info("{}", drain_->text(options_.network.session, closing_.log_file));
  } else {
    say_goodbye();
  }
  closing_.channel = channel_->counters();
  closing_.follower = held_->follower_backlog();
  const int exit_code = close_session(options_, std::move(closing_), log_.writer.get(), *loop_);
  return loop_->superseded() || was_barred ? kExitRuntime : exit_code;
}

void Service::say_goodbye() {
  loop_->close();
  held_->finish();
}

}  // namespace

int serve(const ServerOptions& options, Console* console) {
  give_back_large_memory();
  std::signal(SIGINT, ask_to_stop);
  std::signal(SIGTERM, ask_to_stop);
  std::signal(SIGUSR1, ask_to_drain);
  Service service(options, console);
  const Result<bool> begun = service.begin();
  if (!begun) return say(begun.error());
  if (!*begun) return kExitOk;
  service.play();
  return service.end();
}

}  // namespace mortise
