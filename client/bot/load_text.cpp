#include "client/bot/load_text.h"

#include <fmt/format.h>

#include "client/bot/load_report.h"

namespace mortise {
namespace {

using Json = nlohmann::ordered_json;

std::uint64_t count(const Json& json, const char* key) { return json.at(key).get<std::uint64_t>(); }

std::string latency_line(const char* name, const char* from_to, const Json& l) {
  const auto ms = [&](const char* key) { return l[key].get<double>(); };
  return fmt::format(
      "  {:<12} p50 {:.2f} ms, p90 {:.2f}, p99 {:.2f}, max {:.2f} ({}, {} samples)\n", name,
      ms("p50"), ms("p90"), ms("p99"), ms("max"), from_to, count(l, "count"));
}

std::string title(const Json& d) {
  if (d.contains("processes")) {
    return fmt::format("{} users in {} processes ({:.1f} s)\n", count(d, "users"),
                       count(d, "processes"), d["seconds"].get<double>());
  }
  std::string names;
  std::size_t named = 0;
  for (const Json& name : d["names"]) {
    if (named++ == 4) break;
    names += (names.empty() ? "" : ", ") + name.get<std::string>();
  }
  if (d["names"].size() > 4) names += fmt::format(" and {} more", d["names"].size() - 4);
  return fmt::format("{} ({}, {:.1f} s)\n", names, d["behaviour"].get<std::string>(),
                     d["seconds"].get<double>());
}

std::string refused_text(const Json& refused) {
  std::uint64_t sum = 0;
  std::string by_reason;
  for (const auto& [reason, times] : refused.items()) {
    sum += times.get<std::uint64_t>();
    by_reason +=
        fmt::format("{}{} {}", by_reason.empty() ? " (" : ", ", times.get<std::uint64_t>(), reason);
  }
  return std::to_string(sum) + by_reason + (by_reason.empty() ? "" : ")");
}

std::string what_was_seen(const Json& d) {
  const Json &seen = d["clashes_seen"], &events = d["events"], &state = d["state"];
  return fmt::format(
      "  clashes seen real {}, potential {}, fake {}; {} events, hash {}\n"
      "  at the end   poses {}, {} open clashes {}\n",
      count(seen, "real"), count(seen, "potential"), count(seen, "fake"), count(events, "count"),
      events["hash"].get<std::string>(), state["pose_hash"].get<std::string>(),
      state["open_clashes"].size(), state["clash_hash"].get<std::string>());
}

}  // namespace

std::string load_text(const Json& d) {
  std::string text = title(d);
  text += fmt::format("  increments   sent {}, unacknowledged {}, refused {}\n", count(d, "sent"),
                      count(d, "unacknowledged_increments"), refused_text(d["refused"]));
  text += fmt::format("  commands     sent {}, accepted {}, refused {}, unanswered {}\n",
                      count(d, "commands_sent"), count(d, "commands_accepted"),
                      refused_text(d.at("commands_refused_by")), count(d, "unanswered_commands"));
  text += latency_line("to pose", "increment to pose", d["latency_ms"]);
  text += latency_line("to event", "increment to event", d["event_latency_ms"]);
  text +=
      fmt::format("  lost         events {}, pose batches {}; repaired: {} resyncs for {} events\n",
                  count(d["lost"], "events"), count(d["lost"], "pose_batches"),
                  count(d["repaired"], "resyncs"), count(d["repaired"], "events_by_snapshot"));
  if (d.contains("insertions")) {
    const Json& i = d["insertions"];
    text += fmt::format("  inserted     {} of {}, {} without alignment, {} stuck\n",
                        count(i, "inserted"), count(i, "tries"), count(i, "not_aligned"),
                        count(i, "stuck"));
  }
  if (d.contains("streams")) {
    const Json& s = d["streams"];
    text += fmt::format("  streams      {} events compared in blocks, {} blocks differ\n",
                        count(s, "events_compared"), count(s, "differing_blocks"));
  } else {
    text += what_was_seen(d);
    for (const Json& trouble : d["troubles"]) {
      text += "  not done     " + trouble.get<std::string>() + "\n";
    }
  }
  if (d.contains("limits")) {
    for (const Json& limit : d["limits"]) {
      const std::string name = limit["name"], holds = limit["holds"].get<bool>() ? "ok" : "NO";
      text +=
          name == kExpectClash
              ? fmt::format("  limit        {}: {}\n", limit["meaning"].get<std::string>(), holds)
              : fmt::format("  limit        {} {:.3f}, at most {:g}: {}\n", name,
                            limit["figure"].get<double>(), limit["bound"].get<double>(), holds);
    }
  }
  return text;
}

}  // namespace mortise
