#include "client/bot/load_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "client/bot/stream_digest.h"
#include "common/base/nearest_rank.h"

namespace mortise {
namespace {

using Json = nlohmann::ordered_json;

// Sums of every number of `from` into `into`, object by object.
void add_counts(Json& into, const Json& from) {
  if (!into.is_object()) into = Json::object();
  for (const auto& [key, value] : from.items()) {
    if (value.is_object()) {
      add_counts(into[key], value);
    } else if (value.is_number_integer()) {
      into[key] = into.value(key, std::uint64_t{0}) + value.get<std::uint64_t>();
    }
  }
}

double figure_of(const Json& d, const std::string& name) {
  if (name.starts_with("event_")) {
    return d["event_latency_ms"][name.substr(6, name.size() - 9)].get<double>();
  }
  if (name.ends_with("_ms")) return d["latency_ms"][name.substr(0, name.size() - 3)].get<double>();
  if (name == "refused") {
    double sum = 0.0;
    for (const auto& [reason, count] : d["refused"].items()) sum += count.get<double>();
    return sum;
  }
  if (name == "lost_events") return d["lost"]["events"].get<double>();
  if (name == "missed_poses") return d["lost"]["pose_batches"].get<double>();
  if (name == "unanswered") return d["unanswered_commands"].get<double>();
  if (name == "unacknowledged") return d["unacknowledged_increments"].get<double>();
  if (name == "not_examined" || name == "missed_deadlines")
    return d.contains("server") ? d["server"][name].get<double>() : std::nan("");
  if (name == "resyncs") return d["repaired"]["resyncs"].get<double>();
  if (name == "not_inserted" && d.contains("insertions") && d["insertions"]["tries"] > 0) {
    return d["insertions"]["tries"].get<double>() - d["insertions"]["inserted"].get<double>();
  }
  if (name == "differing_streams") {
    return d.contains("streams") ? d["streams"]["differing_blocks"].get<double>() : 0.0;
  }
  return std::nan("");
}

const char* const kClasses[] = {"none", "fake", "potential", "real"};

std::size_t rank_of(const std::string& collision_class) {
  return static_cast<std::size_t>(
      std::find(std::begin(kClasses), std::end(kClasses), collision_class) - std::begin(kClasses));
}

// Of the same server and pairs: the most that any of them saw.
void take_most(const Json& from, Json& all) {
  if (from.contains("server"))
    for (const auto& [key, value] : from["server"].items())
      all["server"][key] =
          std::max(value.get<std::uint64_t>(),
                   all.contains("server") ? all["server"].value(key, std::uint64_t{0}) : 0);
  if (!from.contains("worst_classes")) return;
  for (const auto& [pair, told] : from["worst_classes"].items()) {
    Json& worst = all["worst_classes"][pair];
    if (worst.is_null() || rank_of(worst) < rank_of(told)) worst = told;
  }
}

LimitResult expected_clash(const Json& document, const Limit& limit) {
  const std::string pair = pair_key(limit.part_a, limit.part_b);
  const std::string told = document.contains("worst_classes")
                               ? document["worst_classes"].value(pair, std::string("none"))
                               : "none";
  const bool holds = told == limit.expected;
  return {limit, pair + ": " + told + " is told, " + limit.expected + " expected",
          holds ? 0.0 : 1.0, holds};
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<') {
      out += "&lt;";
    } else if (c == '&') {
      out += "&amp;";
    } else if (c == '"') {
      out += "&quot;";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace

std::string pair_key(const std::string& part_a, const std::string& part_b) {
  return std::min(part_a, part_b) + ", " + std::max(part_a, part_b);
}

const std::vector<std::pair<std::string, std::string>>& limit_names() {
  static const std::vector<std::pair<std::string, std::string>> names = {
      {"p50_ms", "increment to pose, median"},
      {"p90_ms", "increment to pose, 90th percentile"},
      {"p99_ms", "increment to pose, 99th percentile"},
      {"max_ms", "increment to pose, longest"},
      {"event_p50_ms", "increment to event, median"},
      {"event_p99_ms", "increment to event, 99th percentile"},
      {"event_max_ms", "increment to event, longest"},
      {"refused", "increments refused"},
      {"lost_events", "events that neither arrived nor were covered by a snapshot"},
      {"unanswered", "commands without an answer"},
      {"unacknowledged", "increments without an acknowledgement"},
      {"not_examined", "pairs without a verdict, tick by tick, as the server tells it"},
      {"missed_deadlines", "deadlines that ticks of the server ran past"},
      {"resyncs", "snapshots that replaced events"},
      {"missed_poses", "pose batches that did not arrive"},
      {"not_inserted", "attempts of the behaviour guided that did not insert the part"},
      {"differing_streams", "blocks of the event stream that participants saw differently"},
  };
  return names;
}

std::vector<std::uint8_t> to_bytes(const ProcessReport& report) {
  Json blocks = Json::array();
  for (const auto& [block, hash] : report.stream_blocks) blocks.push_back({block, hash});
  return Json::to_cbor({{"document", report.document},
                        {"latency_ms", report.latency_ms},
                        {"event_latency_ms", report.event_latency_ms},
                        {"stream_blocks", blocks}});
}

bool from_bytes(const std::vector<std::uint8_t>& bytes, ProcessReport& report) {
  const Json json = Json::from_cbor(bytes, true, false);
  if (json.is_discarded() || !json.is_object() || !json.contains("stream_blocks")) return false;
  report.document = json["document"];
  report.latency_ms = json["latency_ms"].get<std::vector<double>>();
  report.event_latency_ms = json["event_latency_ms"].get<std::vector<double>>();
  for (const Json& row : json["stream_blocks"]) {
    report.stream_blocks[row[0].get<std::uint64_t>()] = row[1].get<std::uint64_t>();
  }
  return true;
}

Json percentiles(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double fraction) { return quantile_of_sorted(values, fraction); };
  return {{"count", values.size()},
          {"p50", at(0.5)},
          {"p90", at(0.9)},
          {"p99", at(0.99)},
          {"max", at(1.0)}};
}

Json insertions_json(const std::vector<std::unique_ptr<Behaviour>>& behaviours) {
  Insertions all;
  bool any = false;
  for (const auto& behaviour : behaviours) {
    const Insertions* own = behaviour->insertions();
    if (own == nullptr) continue;
    any = true;
    all.tries += own->tries;
    all.inserted += own->inserted;
    all.not_aligned += own->not_aligned;
    all.stuck += own->stuck;
    all.seconds.insert(all.seconds.end(), own->seconds.begin(), own->seconds.end());
  }
  if (!any) return nullptr;
  return {{"tries", all.tries},
          {"inserted", all.inserted},
          {"not_aligned", all.not_aligned},
          {"stuck", all.stuck},
          {"seconds", percentiles(std::move(all.seconds))}};
}

Json merged(const std::vector<ProcessReport>& reports) {
  Json all;
  std::vector<double> latency_ms, event_latency_ms;
  std::vector<std::map<std::uint64_t, std::uint64_t>> streams;
  all["processes"] = reports.size();
  double seconds = 0.0;
  std::uint64_t users = 0;
  Json counts, participants = Json::array();
  for (const ProcessReport& report : reports) {
    const Json& d = report.document;
    latency_ms.insert(latency_ms.end(), report.latency_ms.begin(), report.latency_ms.end());
    event_latency_ms.insert(event_latency_ms.end(), report.event_latency_ms.begin(),
                            report.event_latency_ms.end());
    streams.push_back(report.stream_blocks);
    seconds = std::max(seconds, d["seconds"].get<double>());
    users += d["names"].size();
    Json sums;
    for (const char* key : {"sent", "not_sent", "refused", "commands_sent", "replies",
                            "commands_accepted", "commands_refused", "commands_refused_by",
                            "unanswered_commands", "unacknowledged_increments", "lost", "repaired",
                            "server_losses", "events_without_increment", "insertions"}) {
      if (d.contains(key)) sums[key] = d[key];
    }
    // Percentiles do not add up.
    if (sums.contains("insertions")) sums["insertions"].erase("seconds");
    add_counts(counts, sums);
    take_most(d, all);
    participants.push_back({{"names", d["names"]},
                            {"sent", d["sent"]},
                            {"latency_ms", d["latency_ms"]},
                            {"events", d["events"]},
                            {"lost", d["lost"]},
                            {"repaired", d["repaired"]},
                            {"pose_hash", d["state"]["pose_hash"]},
                            {"clash_hash", d["state"]["clash_hash"]}});
  }
  const StreamComparison streams_seen = compare_streams(streams);
  all["users"] = users;
  all["seconds"] = seconds;
  all["latency_ms"] = percentiles(std::move(latency_ms));
  all["event_latency_ms"] = percentiles(std::move(event_latency_ms));
  all.update(counts);
  all["streams"] = {{"participants", reports.size()},
                    {"blocks_compared", streams_seen.blocks},
                    {"events_compared", streams_seen.blocks * StreamDigest::kBlock},
                    {"differing_blocks", streams_seen.differing}};
  all["participants"] = std::move(participants);
  return all;
}

std::vector<LimitResult> check_limits(const Json& document, const std::vector<Limit>& limits) {
  std::vector<LimitResult> results;
  for (const Limit& limit : limits) {
    if (limit.name == kExpectClash) {
      results.push_back(expected_clash(document, limit));
      continue;
    }
    LimitResult result{limit, {}, figure_of(document, limit.name), false};
    for (const auto& [name, meaning] : limit_names()) {
      if (name == limit.name) result.meaning = meaning;
    }
    // Without a sample there is nothing that a limit of time could be held against.
    const char* samples = limit.name.starts_with("event_") ? "event_latency_ms" : "latency_ms";
    const bool measured = !limit.name.ends_with("_ms") || document[samples]["count"] > 0;
    result.holds = measured && result.figure <= limit.bound;
    results.push_back(std::move(result));
  }
  return results;
}

Json json_of(const std::vector<LimitResult>& results) {
  Json json = Json::array();
  for (const LimitResult& r : results) {
    json.push_back({{"name", r.limit.name},
                    {"meaning", r.meaning},
                    {"figure", r.figure},
                    {"bound", r.limit.bound},
                    {"holds", r.holds}});
  }
  return json;
}

std::string junit(const std::vector<LimitResult>& results, double seconds) {
  const auto failed = std::count_if(results.begin(), results.end(),
                                    [](const LimitResult& result) { return !result.holds; });
  std::string xml = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<testsuite name=\"mortise-bot\" tests=\"{}\" failures=\"{}\" errors=\"0\" "
      "time=\"{:.3f}\">\n",
      results.size(), failed, seconds);
  for (const LimitResult& r : results) {
    xml += fmt::format("  <testcase classname=\"limit\" name=\"{}\">", escaped(r.limit.name));
    if (!r.holds) {
      xml += fmt::format("<failure message=\"{}: {:g} is above the limit of {:g}\"/>",
                         escaped(r.meaning), r.figure, r.limit.bound);
    }
    xml += fmt::format("<system-out>{}: {:g}, at most {:g}</system-out>", escaped(r.meaning),
                       r.figure, r.limit.bound);
    xml += "</testcase>\n";
  }
  return xml + "</testsuite>\n";
}

}  // namespace mortise
