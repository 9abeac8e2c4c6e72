#include "server/closing.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "common/messages/names.h"

namespace mortise {
namespace {

Json json_of(const DurationHistogram& histogram) {
  return {{"count", histogram.count()},
          {"p50", histogram.percentile_us(0.5)},
          {"p99", histogram.percentile_us(0.99)},
          {"max", histogram.max_us()}};
}

Json json_of(const InboxCounters& c) {
  Json json;
  json["joins"] = c.joins;
  json["joins_refused"] = c.joins_refused;
  json["joins_put_off"] = c.joins_put_off;
  json["leaves"] = c.leaves;
  json["liveliness_lost"] = c.liveliness_lost;
  json["lease_ends"] = c.lease_ends;
  json["commands"] = c.commands;
  json["commands_refused"] = c.commands_refused;
  json["commands_deferred"] = c.commands_deferred;
  json["commands_overdue"] = c.commands_overdue;
  json["increments"] = c.increments;
  json["accepted"] = c.accepted;
  json["repeats"] = c.repeats;
  json["repaired"] = c.repaired;
  json["lost"] = c.lost;
  json["foreign"] = c.foreign;
  json["refused"] = Json::object();
  for (std::size_t i = 1; i < c.refused.size(); ++i) {
    if (c.refused[i] > 0) {
      json["refused"][std::string(name_of(static_cast<Refusal>(i)))] = c.refused[i];
    }
  }
  json["refusals_untold"] = c.refusals_untold;
  json["longest_backlog"] = c.longest_backlog;
  return json;
}

std::string times_line(const char* name, const DurationHistogram& histogram) {
  return fmt::format("  {:<14}{:>12.1f}{:>12.1f}{:>12.1f}\n", name, histogram.percentile_us(0.5),
                     histogram.percentile_us(0.99), histogram.max_us());
}

std::string inbox_lines(const InboxCounters& c) {
  std::string text = fmt::format("  increments {}: accepted {}", c.increments, c.accepted);
  for (std::size_t i = 1; i < c.refused.size(); ++i) {
    if (c.refused[i] == 0) continue;
    text += fmt::format(", {} {}", c.refused[i], name_of(static_cast<Refusal>(i)));
  }
  if (c.repaired + c.lost > 0) {
    text += fmt::format("; {} came only by repetition, {} never", c.repaired, c.lost);
  }
  if (c.longest_backlog > 0) {
    text += fmt::format("; up to {} had to wait for a later tick", c.longest_backlog);
  }
  text += fmt::format(
      "\n  commands {} (refused {}, deferred {}, without what was sent before {}); joined {} "
      "(refused {}), left {}, lost {}, leases "
      "ended {}, foreign {}\n",
      c.commands, c.commands_refused, c.commands_deferred, c.commands_overdue, c.joins,
      c.joins_refused, c.leaves, c.liveliness_lost, c.lease_ends, c.foreign);
  return text;
}

// Those with trouble first; a session of hundreds names ten.
std::string user_lines(const TickLoop& loop) {
  constexpr std::size_t kMostLines = 10;  // chosen: the rest of the report stays in sight
  const std::vector<UserCounters>& counters = loop.inbox().user_counters();
  std::vector<std::size_t> order(std::min(counters.size(), loop.world().users.size()));
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (order.empty()) return {};
  const auto trouble = [&](std::size_t i) {
    return counters[i].refused + counters[i].lost + counters[i].commands_refused;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return trouble(a) > trouble(b); });
  std::string text = fmt::format("  {:<24}{:>10}{:>10}{:>8}{:>10}{:>10}\n", "user", "received",
                                 "refused", "lost", "commands", "refused");
  for (std::size_t n = 0; n < std::min(order.size(), kMostLines); ++n) {
    const UserCounters& c = counters[order[n]];
    text +=
        fmt::format("  {:<24}{:>10}{:>10}{:>8}{:>10}{:>10}\n", loop.world().users[order[n]].name,
                    c.received, c.refused, c.lost, c.commands, c.commands_refused);
  }
  if (order.size() > kMostLines) {
    text += fmt::format("  and {} more with less trouble\n", order.size() - kMostLines);
  }
  return text;
}

}  // namespace

Json closing_json(const Closing& closing, const TickLoop& loop) {
  const TickMetrics& metrics = loop.metrics();
  Json json;
  json["session"] = closing.session;
  json["scenario"] = closing.scenario;
  json["policy"] = closing.policy;
  json["seconds"] = loop.seconds();
  json["tick_rate_hz"] = loop.world().tick_rate_hz;
  json["final_state_hash"] = fmt::format("{:016x}", loop.last_report().state_hash);
  json["statistics"] = mortise::json_of(loop.statistics(), names_of(loop.world()));
  json["times_us"] = {{"tick", json_of(metrics.tick)},
                      {"step", json_of(metrics.step)},
                      {"lateness", json_of(metrics.lateness)},
                      {"delay", json_of(metrics.delay)}};
  json["overloads"] = metrics.overloads;
  json["missed_deadlines"] = metrics.missed_deadlines;
  json["inbox"] = json_of(loop.inbox().counters());
  json["channel"] = mortise::json_of(closing.channel);
  json["parts_without_inside"] = closing.parts_without_inside;
  json["log"] = closing.log_file.empty() ? Json(nullptr)
                                         : Json{{"file", closing.log_file},
                                                {"bytes", closing.log_bytes},
                                                {"dropped_ticks", closing.log_dropped_ticks},
                                                {"error", closing.log_error}};
  json["restored"] = closing.restored_from.empty()
                         ? Json(nullptr)
                         : Json{{"log", closing.restored_from},
                                {"ticks", closing.restored_ticks},
                                {"left_out_ticks", closing.restore_left_out_ticks}};
  json["standby"] = {{"in_step", closing.follower.in_step()},
                     {"times_behind", closing.follower.times_behind()},
                     {"most_ticks_behind", closing.follower.longest_ticks()}};
  json["users"] = Json::array();
  const std::vector<UserCounters>& users = loop.inbox().user_counters();
  for (std::size_t i = 0; i < users.size() && i < loop.world().users.size(); ++i) {
    json["users"].push_back({{"name", loop.world().users[i].name},
                             {"received", users[i].received},
                             {"accepted", users[i].accepted},
                             {"refused", users[i].refused},
                             {"repaired", users[i].repaired},
                             {"lost", users[i].lost},
                             {"commands", users[i].commands},
                             {"commands_refused", users[i].commands_refused}});
  }
  return json;
}

std::string closing_table(const Closing& closing, const TickLoop& loop) {
  const TickMetrics& metrics = loop.metrics();
  const double ticks = static_cast<double>(metrics.ticks);
  std::string text =
      fmt::format("Session {} of {}: {:.1f} s, {} ticks, policy {}, {} parts, {} users\n\n",
                  closing.session, closing.scenario, loop.seconds(), metrics.ticks, closing.policy,
                  loop.world().parts.size(), loop.world().users.size());
  text += collision_table(loop.statistics(), names_of(loop.world()));
  text += "\nWhat the ticks did and did not do\n" + stage_table(loop.statistics().counters());
  text += fmt::format("\nTimes, µs      {:>13}{:>12}{:>12}\n", "p50", "p99", "max");
  text += times_line("tick", metrics.tick) + times_line("of it, engine", metrics.step) +
          times_line("lateness", metrics.lateness) + times_line("delay", metrics.delay);
  text += "  (delay: from send to tick, beyond the fastest increment of the same user)\n";
  text += fmt::format(
      "  deadlines held {:.2f} % ({} ticks ran over, {} deadlines missed)\n",
      ticks > 0 ? 100.0 * (1.0 - static_cast<double>(metrics.missed_deadlines) /
                                     (ticks + static_cast<double>(metrics.missed_deadlines)))
                : 100.0,
      metrics.overloads, metrics.missed_deadlines);
  text += "\nMessages\n" + inbox_lines(loop.inbox().counters());
  const ChannelCounters& c = closing.channel;
  text += fmt::format(
      "  at the door: received {}, malformed {}, foreign {}, lost {}, not sent {}; datagrams "
      "dropped by the guard {}, participants turned away {}\n",
      c.received, c.malformed, c.foreign, c.lost, c.send_failed, c.guard_dropped, c.turned_away);
  text += user_lines(loop);
  if (!closing.restored_from.empty()) {
    text += fmt::format("\nRestored from {}: {} ticks, {} left out\n", closing.restored_from,
                        closing.restored_ticks, closing.restore_left_out_ticks);
  }
  if (closing.follower.times_behind() > 0) {
    text += fmt::format("\nThe server that stood by fell behind {} times, by {} ticks at most\n",
                        closing.follower.times_behind(), closing.follower.longest_ticks());
  }
  if (!closing.parts_without_inside.empty()) {
    text +=
        "\nParts without an inside (open: crossing is found, depth is not, and what lies within is "
        "not examined)\n";
    for (const std::string& part : closing.parts_without_inside) text += "  " + part + "\n";
  }
  if (!closing.log_file.empty()) {
    text += fmt::format("\nSession log: {} ({:.1f} kB", closing.log_file,
                        static_cast<double>(closing.log_bytes) * 1e-3);
    if (closing.log_dropped_ticks > 0) {
      text += fmt::format(", {} ticks missing", closing.log_dropped_ticks);
    }
    text += ")\n";
  }
  return text;
}

}  // namespace mortise
