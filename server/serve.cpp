#include "server/serve.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <deque>
#include <fstream>
#include <iostream>
#include <optional>

#include "idl/dds_channel.h"
#include "server/announcer.h"
#include "server/closing.h"
#include "server/drain.h"
#include "server/held_channel.h"
#include "server/memory.h"
#include "server/metrics_endpoint.h"
#include "server/real_time.h"
#include "server/restore.h"
#include "server/standby.h"
#include "server/start.h"

namespace mortise {
namespace {

constexpr double kShowFiguresEvery_s = 1.0;  // collectors come each few seconds
constexpr double kSayAhead_s = 2.0;          // less is a restart within a moment

std::atomic<bool> stop_asked{false}, drain_asked{false};  // lock-free: set in signal handlers

void ask_to_stop(int) { stop_asked = true; }
void ask_to_drain(int) { drain_asked = true; }

int say(const Error& error) {
  spdlog::error("{}", error.text);
  return exit_code_of(error.code);
}

DdsOptions dds_of(const ServerOptions& options) {
  DdsOptions dds;
  dds.session = options.session;
  dds.domain = options.domain;
  dds.interface = options.interface;
  dds.discovery_port = options.port;
  dds.discovery_server = options.discovery_server;
  dds.keys = options.keys;
  if (!options.peers.empty()) dds.server = options.interface + "," + options.peers;
  return dds;
}

/// Plays the log of before again, when there is one.
Result<std::optional<Resumed>> resume(SessionStart& start, const ServerOptions& options) {
  std::optional<Resumed> resumed;
  if (!start.log) return resumed;
  const auto begun = std::chrono::steady_clock::now();
  const std::uint64_t from_tick = start.scene.world.tick;
  auto played =
      resume_from(*start.log, start.scene.world, options.threads, options.standby_of.empty());
  if (!played) return fail(played.error().code, start.source + ": " + played.error().text);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  spdlog::info("restored from {}: {} ticks{}; {} played again in {:.2f} s, each as it was logged",
               start.source, played->ticks,
               from_tick > 0 ? fmt::format(", the state after tick {} from a checkpoint", from_tick)
                             : std::string(),
               played->ticks_computed, took.count());
  if (played->ticks_left_out > 0) {
    spdlog::warn("{} ticks of {} are left out: {}", played->ticks_left_out, start.source,
                 played->left_out_because);
  }
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
    std::cout << closing_json(closing, loop).dump(2) << std::endl;
  } else {
    std::cout << closing_table(closing, loop) << std::flush;
  }
  if (!options.stats.empty()) {
    std::ofstream out(options.stats);
    out << closing_json(closing, loop).dump(2) << "\n";
    if (!out.flush()) {
      spdlog::error("{}: cannot be written", options.stats);
      exit_code = kExitRuntime;
    }
  }
  return exit_code;
}

}  // namespace

int serve(const ServerOptions& options) {
  give_back_large_memory();
  const bool stands_by = !options.standby_of.empty();
  std::signal(SIGINT, ask_to_stop);
  std::signal(SIGTERM, ask_to_stop);
  std::signal(SIGUSR1, ask_to_drain);
  // One that stands by has nothing to hand over.
  const auto stop = [] { return stop_asked || drain_asked; };
  std::unique_ptr<StandbyChannel> standby;
  std::deque<ToldTick> told;
  if (stands_by) {
    auto opened = open_standby_channel(dds_of(options));
    if (!opened) return say(opened.error());
    standby = std::move(*opened);
    spdlog::info("standing by: waiting for the server of session '{}'", options.session);
    if (!await_leader(*standby, told, stop)) return kExitOk;
  }
  auto start = read_start(options);
  if (!start) return say(start.error());
  World& world = start->scene.world;
  DdsOptions dds = dds_of(options);
  dds.led_until_ms = static_cast<std::uint64_t>(start->led_until_ns / 1'000'000);
  auto channel = stands_by ? Result<std::unique_ptr<ServerChannel>>(std::move(standby))
                           : open_server_channel(dds);
  if (!channel) return say(channel.error());

  // A disk that is full, or a file that may not grow, is an error of the log, not the end.
  std::signal(SIGXFSZ, SIG_IGN);
  auto resumed = resume(*start, options);
  if (!resumed) return say(resumed.error());
  // No log begins before the term under which it is written: the next one finds that term in it.
  const auto term_ns = [&] { return static_cast<std::int64_t>((*channel)->term_ms() * 1'000'000); };
  if (*resumed && (*resumed)->begin)
    (*resumed)->begin->time_ns = std::max((*resumed)->begin->time_ns, term_ns());
  auto log = create_log(options, *start,
                        *resumed ? std::move((*resumed)->begin) : std::optional<LogBegin>());
  if (!log) return say(log.error());

  Closing closing;
  closing.session = options.session;
  closing.scenario = start->source;
  closing.policy = name_of(world.policy);
  closing.log_file = log->file;
  for (std::size_t i = 0; i < start->scene.imports.size() && i < world.parts.size(); ++i) {
    if (!start->scene.imports[i].closed)
      closing.parts_without_inside.push_back(world.parts[i].name);
  }

  std::vector<SeatRecord> seats;
  std::int64_t followed_ns = 0;
  if (stands_by) {
    (void)run_before_others();  // said below
    Follower follower(world, (*resumed)->statistics, log->writer.get(), options.threads);
    auto& line = static_cast<StandbyChannel&>(**channel);
    auto ended = follow(line, std::move(told), follower, stop,
                        [](const std::string& note) { spdlog::info("standing by: {}", note); });
    if (!ended) return say(ended.error());
    if (!*ended) return kExitOk;
    seats = follower.seats();
    followed_ns = follower.time_ns();
    run_as_others();  // and the threads of the endpoints
    if (Status taken = line.take_over(); !taken) return say(taken.error());
    if (log->writer)
      if (Status named = log->writer->take_name(); !named) spdlog::error("{}", named.error().text);
    spdlog::warn("the server of session '{}' {}: taken over at tick {}, {} users", options.session,
                 follower.handed_over() ? "hands over" : "is gone", world.tick, seats.size());
  }

  if (const Status first = run_before_others(); !first) spdlog::info("{}", first.error().text);
  // No tick is logged before the term of its server: so the next one finds a later term in the log.
  SystemClock clock(std::max(term_ns(), followed_ns));
  if (const double ahead_s = clock.ahead_s(); ahead_s > kSayAhead_s)
    spdlog::warn(
        "the clock of this machine is {:.0f} s behind the last tick of {}: the log's "
        "times go on from there",
        ahead_s, start->source);
  TickLoopOptions loop_options;
  loop_options.session = options.session;
  loop_options.threads = options.threads;
  loop_options.inbox = options.limits;
  const TickLoop* running = nullptr;
  HeldChannel held(**channel, clock, [&] { return running->inbox().users_present(); });
  TickLoop loop(world, held, clock, log->writer.get(), loop_options);
  running = &loop;
  if (Resumed* before = resumed->has_value() ? &**resumed : nullptr; before != nullptr) {
    closing.restored_from = start->source;
    closing.restored_ticks = before->ticks;
    closing.restore_left_out_ticks = before->ticks_left_out;
    if (stands_by) {
      held.await(seats);
      loop.adopt(std::move(before->statistics), seats);
    } else {
      loop.resume(std::move(before->statistics), std::move(before->departures));
    }
  }
  loop.open();
  spdlog::info("session '{}' of {} on domain {}, {}: {} parts, {:g} Hz, policy {}{}",
               options.session, start->source, options.domain, options.interface,
               world.parts.size(), world.tick_rate_hz, closing.policy,
               closing.log_file.empty() ? std::string() : ", log " + closing.log_file);
  for (const std::string& part : closing.parts_without_inside) {
    spdlog::warn("'{}' has no inside (open or non-manifold): crossing is found, depth is not",
                 part);
  }

  std::unique_ptr<MetricsEndpoint> metrics;
  if (options.metrics_port) {
    auto opened = MetricsEndpoint::open(options.metrics_address, *options.metrics_port);
    if (!opened) return say(opened.error());
    metrics = std::move(*opened);
    spdlog::info("metrics at http://{}:{}/metrics", options.metrics_address, metrics->port());
  }
  double shown_at_s = -kShowFiguresEvery_s;
  const auto show_figures = [&] {
    if (!metrics) return;
    metrics->beat();
    if (loop.seconds() - shown_at_s < kShowFiguresEvery_s) return;
    shown_at_s = loop.seconds();
    metrics->show(
        figures_of(loop, (*channel)->counters(), options.session, held.follower_backlog()));
  };
  Announcer announcer(options.live, options.quiet);
  Drain drain(loop, held, clock);
  loop.run(
      [&] {
        return stop_asked || loop.superseded() || !(*channel)->barred().empty() ||
               (drain_asked && drain.is_ready()) ||
               (options.duration_s > 0.0 && loop.seconds() >= options.duration_s);
      },
      [&] {
        announcer.after_tick(loop);
        for (const std::string& note : held.take_notes()) spdlog::warn("{}", note);
        show_figures();
      });
  announcer.finish();
  const bool barred = !(*channel)->barred().empty();
  const auto say_goodbye = [&] {
    loop.close();
    held.finish();
  };
  if (drain.begun() && !stop_asked && !loop.superseded() && !barred) {
    drain.finish([&] {
      if (metrics) metrics->beat();
      return !stop_asked;
    });
  }
  if (loop.superseded()) {
    spdlog::error("another server leads session '{}' since; start this one with --standby-of {}",
                  options.session, options.session);
  } else if (barred) {
    spdlog::error("{}", (*channel)->barred());
    // One that stands by goes on with the session, and takes nothing more from this one.
    if (!held.follower_in_step()) say_goodbye();
  } else if (drain.end() != Drain::End::kNone) {
    spdlog::info("{}", drain.text(options.session, closing.log_file));
  } else {
    say_goodbye();
  }
  closing.channel = (*channel)->counters();
  closing.follower = held.follower_backlog();
  const int exit_code = close_session(options, std::move(closing), log->writer.get(), loop);
  return loop.superseded() || barred ? kExitRuntime : exit_code;
}

}  // namespace mortise
