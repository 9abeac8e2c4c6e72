#include "server/announcer.h"

#include <fstream>
#include <sstream>
#include <utility>

#include "common/evaluation/clash_line.h"
#include "common/io/progress_log.h"
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
      "{:.1f} s, {} | open: {} real, {} potential, {} fake | tick p99 {:.1f} ms", seconds,
      pulse.users == 1 ? "1 user" : fmt::format("{} users", pulse.users), pulse.clashes_open[3],
      pulse.clashes_open[2], pulse.clashes_open[1], pulse.tick_p99_us * 1e-3);
  if (pulse.refused > 0) line += fmt::format(" | {} refused", pulse.refused);
  if (pulse.missed_deadlines > 0)
    line += fmt::format(" | {} deadlines missed", pulse.missed_deadlines);
  return line;
}

std::vector<std::string> address_lines(std::istream& written) {
  std::vector<std::string> lines;
  std::string to_take_part;
  for (std::string line; std::getline(written, line);) {
    std::istringstream words(line);
    std::string role, address, more;
    words >> role >> address;
    if (words >> more) {  // of persons: each knows who
      lines.push_back(line);
    } else if (role == "designer") {
      to_take_part = "open in a browser:  " + address;
    } else if (!address.empty()) {
      lines.push_back("to look on only:    " + address);
    }
  }
  if (!to_take_part.empty()) lines.push_back(to_take_part);
  return lines;
}

Announcer::Announcer(AnnouncerOptions options, Console* console)
    : options_(std::move(options)), console_(console) {
  if (console_ != nullptr) style_ = style_of_stderr();
}

void Announcer::after_tick(const TickLoop& loop) {
  if (!options_.quiet) {
    say_people(loop);
    say_clashes(loop);
  }
  say_trouble(loop);
  if (options_.live) say_live(loop);
}

void Announcer::say_people(const TickLoop& loop) {
  const World& world = loop.world();
  for (const Decision& decision : loop.last_intake().decisions) {
    const User* user = world.find(decision.user);
    const Part* part = decision.part ? world.find(decision.part) : nullptr;
    const std::string name = user != nullptr ? user->name : "?";
    switch (decision.kind) {
      case Decision::Kind::kJoin:
        log_info("{} joined", decision.user_name);
        break;
      case Decision::Kind::kLeave:
        log_info("{} left", name);
        break;
      case Decision::Kind::kLivelinessLost:
        log_warning("{} left without goodbye; its parts are free", name);
        break;
      case Decision::Kind::kLeaseEnd:
        log_warning("{} was silent for {:g} s: '{}' is free", name, world.lease_s,
                    part != nullptr ? part->name : "?");
        break;
      default:
        log_debug("{}: {} '{}'", name, name_of(decision.kind), part != nullptr ? part->name : "?");
    }
  }
}

void Announcer::say_clashes(const TickLoop& loop) {
  const StepReport& report = loop.last_report();
  if (report.events.empty()) return;
  const SessionNames names = names_of(loop.world());
  for (const ClashEvent& event : report.events) {
    if (event.kind == ClashEvent::Kind::kEnd) {
      say_end(event, loop.world(), names);
      worst_said_.erase(event.clash);
    } else {
      say_clash(event, loop.world(), names);
    }
  }
}

// One that begins, or is worse than all that was said of it.
void Announcer::say_clash(const ClashEvent& event, const World& world, const SessionNames& names) {
  const CollisionClass now = event.verdict.collision_class;
  CollisionClass& said = worst_said_[event.clash];
  if (now <= said) return;
  const PairRule* rule = world.rule(event.part_a, event.part_b);
  ClashLine line{names.part(event.part_a),
                 names.part(event.part_b),
                 &event.verdict,
                 rule != nullptr ? rule->fit : "",
                 0,
                 fmt::format("clash {}", event.clash.value)};
  if (event.review.status == ReviewStatus::kApproved) line.note += ", approved";
  if (event.user) line.note += " by " + names.user(event.user);
  said = now;
  say_line(clash_line(line), now);
}

// That parts which may touch are apart again is no news.
void Announcer::say_end(const ClashEvent& event, const World& world, const SessionNames& names) {
  if (event.worst_class <= CollisionClass::kFake) return;
  const std::string how_long = fmt::format(
      "was {} for {:.1f} s   clash {}", name_of(event.worst_class),
      static_cast<double>(event.tick - event.begin_tick) / world.tick_rate_hz, event.clash.value);
  say_line(pair_line("ENDED", names.part(event.part_a), names.part(event.part_b), how_long),
           CollisionClass::kNone);
}

void Announcer::say_line(const std::string& line, CollisionClass collision_class) const {
  log_info("{}", style_.color ? coloured_line(line, collision_class) : line);
}

void Announcer::say_trouble(const TickLoop& loop) {
  for (const std::string& who : loop.last_intake().turned_away) {
    if (++turned_away_said_ > kMostTurnedAway) break;  // counted in the closing document
    log_warning("{}", who);
  }
  if (const std::string news = waiting_.after_tick(loop.last_report(), loop.world()); !news.empty())
    log_warning("{}", news);
  if (loop.seconds() - trouble_at_s_ < kTroubleEvery_s) return;
  trouble_at_s_ = loop.seconds();
  const SessionPulse pulse = loop.pulse();
  const TickMetrics& metrics = loop.metrics();
  if (metrics.overloads > overloads_) {
    log_warning(
        "overload: {} ticks ran past their deadline, {} deadlines missed (tick p99 {:.1f} ms of "
        "{:.1f} ms)",
        metrics.overloads - overloads_, metrics.missed_deadlines - missed_,
        pulse.tick_p99_us * 1e-3, 1e3 / loop.world().tick_rate_hz);
  }
  if (pulse.refused > refused_)
    log_warning("{} increments refused ({} in all)", pulse.refused - refused_, pulse.refused);
  say_log(loop);
  overloads_ = metrics.overloads;
  missed_ = metrics.missed_deadlines;
  refused_ = pulse.refused;
}

void Announcer::say_log(const TickLoop& loop) {
  if (loop.log() != nullptr && !log_failed_) {
    if (const Status status = loop.log()->status(); !status) {
      log_failed_ = true;
      log_error("{}; the session continues, and unrecorded ticks are counted", status.error().text);
    }
  }
  if (!log_failed_ && loop.log_dropped_ticks() > dropped_)
    log_warning("the log's disk is too slow: {} ticks are missing in it (marked as a gap)",
                loop.log_dropped_ticks() - dropped_);
  dropped_ = loop.log_dropped_ticks();
}

void Announcer::say_live(const TickLoop& loop) {
  const double every_s = style_.terminal ? kTerminalRefresh_s : kLineEveryWithoutTty_s;
  if (loop.seconds() - live_at_s_ < every_s) return;
  live_at_s_ = loop.seconds();
  const std::string line = live_line(loop.pulse(), loop.seconds());
  if (!style_.terminal) {
    log_info("{}", line);
    return;
  }
  if (addresses_.empty() && !options_.addresses.empty()) {
    std::ifstream written(options_.addresses);  // renamed to its name when it is whole
    addresses_ = address_lines(written);
  }
  std::vector<std::string> lines{line};
  lines.insert(lines.end(), addresses_.begin(), addresses_.end());
  console_->stay(std::move(lines));
}

void Announcer::finish() {
  if (console_ != nullptr) console_->leave();
}

}  // namespace mortise
