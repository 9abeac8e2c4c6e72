#include "server/metrics_text.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "common/messages/names.h"

namespace mortise {
namespace {

DurationFigures figures_of(const DurationHistogram& histogram) {
  DurationFigures figures{histogram.count(), histogram.sum_s(), {}};
  for (std::size_t i = 0; i < kDurationBounds_s.size(); ++i)
    figures.up_to[i] = histogram.count_up_to(std::llround(kDurationBounds_s[i] * 1e9));
  return figures;
}

/// Backslash, quote and line feed are what the format escapes in a label.
std::string label(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\' || c == '"') escaped += '\\';
    escaped += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return escaped;
}

class Text {
 public:
  void family(const char* name, const char* kind, const char* help) {
    name_ = name;
    text_ += fmt::format("# HELP {0} {2}\n# TYPE {0} {1}\n", name, kind, help);
  }
  template <class Number>
  void value(Number number, const std::string& labels = {}) {
    text_ += labels.empty() ? fmt::format("{} {}\n", name_, number)
                            : fmt::format("{}{{{}}} {}\n", name_, labels, number);
  }
  template <class Number>
  void one(const char* name, const char* kind, const char* help, Number number) {
    family(name, kind, help);
    value(number);
  }
  void durations(const char* name, const char* help, const DurationFigures& d) {
    family(name, "histogram", help);
    name_ = std::string(name) + "_bucket";
    for (std::size_t i = 0; i < kDurationBounds_s.size(); ++i)
      value(d.up_to[i], fmt::format("le=\"{:g}\"", kDurationBounds_s[i]));
    value(d.count, "le=\"+Inf\"");
    name_ = std::string(name) + "_sum";
    value(d.sum_s);
    name_ = std::string(name) + "_count";
    value(d.count);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string name_, text_;
};

void add_ticks(Text& out, const SessionFigures& f) {
  out.family("mortise_session_info", "gauge", "The session; always 1");
  out.value(1, fmt::format("session=\"{}\",policy=\"{}\"", label(f.session), label(f.policy)));
  out.one("mortise_tick_rate_hertz", "gauge", "Ticks a second as the scenario asks",
          f.tick_rate_hz);
  out.one("mortise_uptime_seconds", "gauge", "Since the session began here", f.seconds);
  out.one("mortise_tick", "gauge", "Number of the last tick", f.tick);
  out.one("mortise_ticks_total", "counter", "Ticks carried out here", f.ticks);
  out.one("mortise_overloads_total", "counter", "Ticks that ran past the next deadline",
          f.overloads);
  out.one("mortise_missed_deadlines_total", "counter", "Deadlines passed over because of them",
          f.missed_deadlines);
  out.durations("mortise_tick_seconds", "Time of a tick, drain to publish", f.tick_s);
  out.durations("mortise_step_seconds", "The engine's part of it", f.step_s);
  out.durations("mortise_lateness_seconds", "Begin of a tick after its deadline", f.lateness_s);
  out.durations("mortise_delay_seconds",
                "Send to tick, beyond the fastest increment of the same user", f.delay_s);
}

void add_messages(Text& out, const SessionFigures& f) {
  const InboxCounters& c = f.inbox;
  out.one("mortise_users", "gauge", "Users in the session", f.users_present);
  out.one("mortise_joins_total", "counter", "Joins admitted", c.joins);
  out.one("mortise_joins_refused_total", "counter", "Joins refused", c.joins_refused);
  out.one("mortise_leaves_total", "counter", "Goodbyes", c.leaves);
  out.one("mortise_liveliness_lost_total", "counter", "Gone without goodbye", c.liveliness_lost);
  out.one("mortise_lease_ends_total", "counter", "Parts freed because their holder was silent",
          c.lease_ends);
  out.one("mortise_increments_total", "counter", "Increments received", c.increments);
  out.one("mortise_increments_accepted_total", "counter", "Increments given to a tick", c.accepted);
  out.one("mortise_increments_repaired_total", "counter", "Increments that came only by repetition",
          c.repaired);
  out.one("mortise_increments_lost_total", "counter", "Increments numbered, and never come",
          c.lost);
  out.family("mortise_increments_refused_total", "counter", "Increments refused, by reason");
  for (std::size_t i = 1; i < c.refused.size(); ++i) {
    out.value(c.refused[i],
              fmt::format("reason=\"{}\"", label(std::string(name_of(static_cast<Refusal>(i))))));
  }
  out.one("mortise_refusals_untold_total", "counter", "Refusals counted, but not told",
          c.refusals_untold);
  out.one("mortise_commands_total", "counter", "Commands received", c.commands);
  out.one("mortise_commands_refused_total", "counter", "Commands refused", c.commands_refused);
  out.one("mortise_foreign_total", "counter", "Sent for a user of another participant", c.foreign);
  out.family("mortise_queue_length", "gauge", "What waits for a later tick, or for the disk");
  out.value(f.waiting_increments, "queue=\"increments\"");
  out.value(f.waiting_commands, "queue=\"commands\"");
  out.value(f.log_queued_ticks, "queue=\"log_ticks\"");
  out.one("mortise_longest_backlog", "gauge", "Most increments that ever waited",
          c.longest_backlog);
}

void add_users(Text& out, const SessionFigures& f) {
  using User = SessionFigures::User;
  const auto each = [&](const char* name, const char* kind, const char* help, auto number) {
    out.family(name, kind, help);
    for (const User& user : f.users) {
      out.value(number(user), fmt::format("user=\"{}\"", label(user.name)));
    }
  };
  each("mortise_user_present", "gauge", "1: in the session now",
       [](const User& u) { return u.present ? 1 : 0; });
  each("mortise_user_parts_held", "gauge", "Parts in the user's hand",
       [](const User& u) { return u.parts_held; });
  each("mortise_user_increments_total", "counter", "Increments received from the user",
       [](const User& u) { return u.counters.received; });
  each("mortise_user_increments_accepted_total", "counter", "Of these, given to a tick",
       [](const User& u) { return u.counters.accepted; });
  each("mortise_user_increments_refused_total", "counter", "Of these, refused",
       [](const User& u) { return u.counters.refused; });
  each("mortise_user_increments_repaired_total", "counter", "Came only by repetition",
       [](const User& u) { return u.counters.repaired; });
  each("mortise_user_increments_lost_total", "counter", "Numbered by the user, and never came",
       [](const User& u) { return u.counters.lost; });
  each("mortise_user_commands_total", "counter", "Commands received from the user",
       [](const User& u) { return u.counters.commands; });
  each("mortise_user_commands_refused_total", "counter", "Of these, refused",
       [](const User& u) { return u.counters.commands_refused; });
}

void add_clashes(Text& out, const SessionFigures& f) {
  const auto by_class = [&](const std::array<std::uint64_t, 4>& counts) {
    for (std::size_t c = 1; c < counts.size(); ++c) {
      out.value(counts[c], fmt::format("class=\"{}\"", name_of(static_cast<CollisionClass>(c))));
    }
  };
  out.family("mortise_clashes_open", "gauge", "Clashes that are open now, by class");
  by_class(f.clashes_open);
  out.family("mortise_clashes_total", "counter", "Clashes since the session began, by worst class");
  by_class(f.clashes_total);
}

void add_stages(Text& out, const SessionFigures& f) {
  const StepCounters& s = f.stages;
  out.family("mortise_pairs_total", "counter", "Candidate pairs, and those asked for contact");
  out.value(s.pairs.in, "stage=\"candidates\"");
  out.value(s.pairs.out, "stage=\"asked\"");
  out.family("mortise_pairs_skipped_total", "counter", "Pairs not asked, by reason");
  out.value(s.pairs_static, "reason=\"both static\"");
  out.value(s.pairs_still, "reason=\"both still\"");
  out.value(s.pairs_excluded, "reason=\"excluded\"");
  out.value(s.pairs_boxes_apart, "reason=\"boxes apart\"");
  out.value(s.pairs_budget, "reason=\"known apart\"");
  out.one("mortise_pairs_waiting_total", "counter",
          "Pairs left waiting for a search or a verdict: the tick had no work left",
          s.pairs_waiting);
  out.one("mortise_not_examined_total", "counter",
          "Pairs given up by a work cap or overload; never reported as clear", s.not_examined);
  out.one("mortise_stopped_parts_total", "counter", "Parts stopped by a real contact",
          s.stopped_parts);
  out.family("mortise_queries_total", "counter", "Questions asked of the engine");
  out.value(s.first_contact_queries, "kind=\"first contact\"");
  out.value(s.distance_queries, "kind=\"distance\"");
  out.value(s.depth_queries, "kind=\"depth\"");
  out.value(s.event_time_queries, "kind=\"event time\"");
  out.one("mortise_event_times_at_latest_total", "counter",
          "Times of events that a work cap left unproven to be the first", s.event_times_at_latest);
}

void add_process(Text& out, const SessionFigures& f, std::uint64_t resident) {
  const ChannelCounters& c = f.channel;
  out.family("mortise_samples_total", "counter", "Samples at the door, by what became of them");
  out.value(c.received, "fate=\"received\"");
  out.value(c.malformed, "fate=\"malformed\"");
  out.value(c.foreign, "fate=\"foreign\"");
  out.value(c.lost, "fate=\"lost\"");
  out.value(c.send_failed, "fate=\"not sent\"");
  out.one("mortise_datagrams_cut_total", "counter", "Datagrams that the guard dropped",
          c.guard_dropped);
  out.one("mortise_participants_turned_away_total", "counter",
          "Participants that could not prove who they are, or may not be here", c.turned_away);
  out.one("mortise_standby_in_step", "gauge", "1: a server stands by that could go on at once",
          f.follower.in_step() ? 1 : 0);
  out.one("mortise_standby_ticks_behind", "gauge",
          "Ticks that it was told and has not computed yet", f.follower.ticks());
  out.one("mortise_standby_most_ticks_behind", "gauge", "Most that these ever were",
          f.follower.longest_ticks());
  out.one("mortise_standby_fell_behind_total", "counter", "How often they became more than 30",
          f.follower.times_behind());
  out.one("mortise_log_open", "gauge", "1: a session log is written, and the disk takes it",
          f.has_log && !f.log_failed ? 1 : 0);
  out.one("mortise_log_failed", "gauge", "1: the disk refused the log; ticks go unrecorded",
          f.log_failed ? 1 : 0);
  out.one("mortise_log_bytes", "gauge", "Size of the session log", f.log_bytes);
  out.one("mortise_log_dropped_ticks_total", "counter", "Ticks that are not in the log",
          f.log_dropped_ticks);
  if (resident > 0) {
    out.one("process_resident_memory_bytes", "gauge", "Memory of the server in use", resident);
  }
}

}  // namespace

SessionFigures figures_of(const TickLoop& loop, const ChannelCounters& channel,
                          const std::string& session, const Backlog& follower) {
  const World& world = loop.world();
  const TickMetrics& metrics = loop.metrics();
  SessionFigures f;
  f.session = session;
  f.policy = name_of(world.policy);
  f.tick_rate_hz = world.tick_rate_hz;
  f.seconds = loop.seconds();
  f.tick = world.tick;
  f.ticks = metrics.ticks;
  f.overloads = metrics.overloads;
  f.missed_deadlines = metrics.missed_deadlines;
  f.tick_s = figures_of(metrics.tick);
  f.step_s = figures_of(metrics.step);
  f.lateness_s = figures_of(metrics.lateness);
  f.delay_s = figures_of(metrics.delay);
  f.inbox = loop.inbox().counters();
  f.users_present = loop.inbox().users_present();
  f.waiting_increments = loop.inbox().waiting_increments();
  f.waiting_commands = loop.inbox().waiting_commands();
  const std::vector<UserCounters>& counters = loop.inbox().user_counters();
  for (std::size_t i = 0; i < world.users.size(); ++i) {
    f.users.push_back({world.users[i].name, world.users[i].present, 0,
                       i < counters.size() ? counters[i] : UserCounters{}});
  }
  for (const Part& part : world.parts) {
    if (part.holder && part.holder.value <= f.users.size()) {
      ++f.users[part.holder.value - 1].parts_held;
    }
  }
  for (std::size_t c = 1; c < 4; ++c) {
    f.clashes_open[c] = loop.statistics().clashes_open(static_cast<CollisionClass>(c));
    f.clashes_total[c] = loop.statistics().clashes_total(static_cast<CollisionClass>(c));
  }
  f.stages = loop.statistics().counters();
  f.channel = channel;
  f.follower = follower;
  if (const SessionLogWriter* log = loop.log(); log != nullptr) {
    f.has_log = true;
    f.log_failed = !log->status();
    f.log_bytes = log->bytes_written();
    f.log_queued_ticks = log->queued_ticks();
    f.log_dropped_ticks = log->dropped_ticks();
  }
  return f;
}

std::string metrics_text(const SessionFigures& figures, std::uint64_t resident) {
  Text out;
  add_ticks(out, figures);
  add_messages(out, figures);
  add_users(out, figures);
  add_clashes(out, figures);
  add_stages(out, figures);
  add_process(out, figures, resident);
  return out.take();
}

std::uint64_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t total_pages = 0, resident_pages = 0;
  if (!(statm >> total_pages >> resident_pages)) return 0;
  return resident_pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace mortise
