#include "server/announcer.h"

#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "common/evaluation/clash_line.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

constexpr double kTroubleEvery_s = 1.0;         // a flood of refusals must not flood the terminal
constexpr std::uint64_t kMostTurnedAway = 100;  // in a session, each of them a line
constexpr double kTerminalRefresh_s = 0.2;      // as often as an eye follows
constexpr double kLineEveryWithoutTty_s = 5;    // in a file, a line is kept for good

}  // namespace

std::string live_line(const SessionPulse& pulse, double seconds) {
  std::string line = fmt::format(
      "{:.1f} s, tick {}, {} users | open: {} real, {} potential, {} fake | tick p99 {:.1f} ms",
      seconds, pulse.tick, pulse.users, pulse.clashes_open[3], pulse.clashes_open[2],
      pulse.clashes_open[1], pulse.tick_p99_us * 1e-3);
  if (pulse.refused > 0) line += fmt::format(" | {} refused", pulse.refused);
  if (pulse.missed_deadlines > 0)
    line += fmt::format(" | {} deadlines missed", pulse.missed_deadlines);
  return line;
}

Announcer::Announcer(bool live, bool quiet)
    : live_(live), quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

void Announcer::clear_line() {
  if (!line_open_) return;
  std::fputs("\r\033[K", stderr);
  line_open_ = false;
}

void Announcer::after_tick(const TickLoop& loop) {
  if (!quiet_) {
    say_people(loop);
    say_clashes(loop);
  }
  say_trouble(loop);
  if (live_) say_live(loop);
}

void Announcer::say_people(const TickLoop& loop) {
  const World& world = loop.world();
  for (const Decision& decision : loop.last_intake().decisions) {
    const User* user = world.find(decision.user);
    const Part* part = decision.part ? world.find(decision.part) : nullptr;
    const std::string name = user != nullptr ? user->name : "?";
    clear_line();
    switch (decision.kind) {
      case Decision::Kind::kJoin:
        spdlog::info("{} joined", decision.user_name);
        break;
      case Decision::Kind::kLeave:
        spdlog::info("{} left", name);
        break;
      case Decision::Kind::kLivelinessLost:
        spdlog::warn("{} left without goodbye; its parts are free", name);
        break;
      case Decision::Kind::kLeaseEnd:
        spdlog::warn("{} was silent for {:g} s: '{}' is free", name, world.lease_s,
                     part != nullptr ? part->name : "?");
        break;
      default:
        spdlog::debug("{}: {} '{}'", name, name_of(decision.kind),
                      part != nullptr ? part->name : "?");
    }
  }
}

void Announcer::say_clashes(const TickLoop& loop) {
  const StepReport& report = loop.last_report();
  if (report.events.empty()) return;
  const SessionNames names = names_of(loop.world());
  for (const ClashEvent& event : report.events) {
    const PairRule* rule = loop.world().rule(event.part_a, event.part_b);
    ClashLine line{names.part(event.part_a),
                   names.part(event.part_b),
                   &event.verdict,
                   rule != nullptr ? rule->fit : "",
                   0,
                   fmt::format("clash {}", event.clash.value)};
    clear_line();
    if (event.kind == ClashEvent::Kind::kBegin) {
      if (event.user) line.note += " by " + names.user(event.user);
      spdlog::info("{}", clash_line(line));
      spdlog::debug("clash {}: {}", event.clash.value, event.verdict.explanation);
    } else if (event.kind == ClashEvent::Kind::kEnd) {
      spdlog::info("clash {} ends: {} × {}, worst {}, {:.1f} s", event.clash.value, line.part_a,
                   line.part_b, name_of(event.worst_class),
                   static_cast<double>(event.tick - event.begin_tick) / loop.world().tick_rate_hz);
    } else {
      spdlog::debug("{}", clash_line(line));
    }
  }
}

void Announcer::say_trouble(const TickLoop& loop) {
  for (const std::string& who : loop.last_intake().turned_away) {
    if (++turned_away_said_ > kMostTurnedAway) break;  // counted in the closing document
    clear_line();
    spdlog::warn("{}", who);
  }
  if (loop.seconds() - trouble_at_s_ < kTroubleEvery_s) return;
  trouble_at_s_ = loop.seconds();
  const SessionPulse pulse = loop.pulse();
  const TickMetrics& metrics = loop.metrics();
  if (metrics.overloads > overloads_) {
    clear_line();
    spdlog::warn(
        "overload: {} ticks ran past their deadline, {} deadlines missed (tick p99 {:.1f} ms of "
        "{:.1f} ms)",
        metrics.overloads - overloads_, metrics.missed_deadlines - missed_,
        pulse.tick_p99_us * 1e-3, 1e3 / loop.world().tick_rate_hz);
  }
  if (pulse.refused > refused_) {
    clear_line();
    spdlog::warn("{} increments refused ({} in all)", pulse.refused - refused_, pulse.refused);
  }
  if (pulse.not_examined > not_examined_) {
    clear_line();
    spdlog::warn("{} pairs not examined to the end; they are not reported as clear",
                 pulse.not_examined - not_examined_);
  }
  if (loop.log() != nullptr && !log_failed_) {
    if (const Status status = loop.log()->status(); !status) {
      log_failed_ = true;
      clear_line();
      spdlog::error("{}; the session continues, and unrecorded ticks are counted",
                    status.error().text);
    }
  }
  if (!log_failed_ && loop.log_dropped_ticks() > dropped_) {
    clear_line();
    spdlog::warn("the log's disk is too slow: {} ticks are missing in it (marked as a gap)",
                 loop.log_dropped_ticks() - dropped_);
  }
  overloads_ = metrics.overloads;
  missed_ = metrics.missed_deadlines;
  refused_ = pulse.refused;
  not_examined_ = pulse.not_examined;
  dropped_ = loop.log_dropped_ticks();
}

void Announcer::say_live(const TickLoop& loop) {
  const double every_s = terminal_ ? kTerminalRefresh_s : kLineEveryWithoutTty_s;
  if (loop.seconds() - live_at_s_ < every_s) return;
  live_at_s_ = loop.seconds();
  std::string line = live_line(loop.pulse(), loop.seconds());
  if (terminal_) {
    // A line that wraps could not be overwritten.
    winsize window{};
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0) {
      line.resize(std::min<std::size_t>(line.size(), window.ws_col - 1));
    }
    std::fprintf(stderr, "\r\033[K%s", line.c_str());
    line_open_ = true;
  } else {
    std::fprintf(stderr, "%s\n", line.c_str());
  }
  std::fflush(stderr);
}

void Announcer::finish() {
  if (line_open_) std::fputs("\n", stderr);
  line_open_ = false;
}

}  // namespace mortise
