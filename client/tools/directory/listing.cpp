#include "client/tools/directory/listing.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/base/json_text.h"

namespace mortise {
namespace {

// Keeps a row on one line of a terminal; a name may have 64 letters.
constexpr std::size_t kMostOfName = 40;

const char* name_of(KnownServer::Place place) {
  switch (place) {
    case KnownServer::Place::kLeads:
      return "leads";
    case KnownServer::Place::kStandsBy:
      return "stands by";
    case KnownServer::Place::kOvertaken:
      return "overtaken";
  }
  return "";
}

/// Names come from the wire: no control characters for the terminal.
std::string shown(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  if (name.size() > kMostOfName) name = name.substr(0, kMostOfName - 3) + "...";
  return name.empty() ? "-" : name;
}

std::string since(std::uint64_t term) {
  constexpr std::uint64_t kEndOfTime_ms = 253'402'300'800'000;  // the year 10000
  if (term == 0 || term >= kEndOfTime_ms) return "-";
  return fmt::format("{:%Y-%m-%d %H:%M:%S}", fmt::gmtime(static_cast<std::time_t>(term / 1000)));
}

/// The 99th percentile of a tick's work as a share of the time that a tick has.
std::optional<double> load_of(const KnownServer& server) {
  if (!server.pulse || !server.tick_rate_hz) return std::nullopt;
  return server.pulse->tick_p99_us * 1e-6 * *server.tick_rate_hz;
}

template <class Value>
std::string or_dash(const std::optional<Value>& value, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value) : "-";
}

template <class Value>
nlohmann::json or_null(const std::optional<Value>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

}  // namespace

std::string listing_text(const std::vector<ListedServer>& servers) {
  constexpr const char* kRow =
      "{:<20} {:>6}  {:<21} {:<10} {:<20} {:>5} {:>6} {:>7} {:>9} {:>5}  {}\n";
  std::string text = fmt::format(kRow, "session", "domain", "server", "", "since (UTC)", "users",
                                 "parts", "ticks/s", "p99, ms", "load", "version");
  for (const auto& [domain, server] : servers) {
    const auto& pulse = server.pulse;
    const std::optional<double> load = load_of(server);
    text += fmt::format(
        kRow, shown(server.session), domain,
        server.address.empty() ? "-" : fmt::format("{}:{}", server.address, server.port),
        name_of(server.place), since(server.term), pulse ? fmt::format("{}", pulse->users) : "-",
        or_dash(server.parts, "{}"), or_dash(server.tick_rate_hz, "{:g}"),
        pulse ? fmt::format("{:.2f}", pulse->tick_p99_us * 1e-3) : "-",
        load ? fmt::format("{:.0f} %", 100.0 * *load) : "-", shown(server.version));
  }
  return text;
}

std::string listing_json(const std::vector<ListedServer>& servers) {
  nlohmann::ordered_json document;
  document["servers"] = nlohmann::ordered_json::array();
  for (const auto& [domain, server] : servers) {
    const auto& pulse = server.pulse;
    nlohmann::ordered_json row;
    row["session"] = server.session;
    row["domain"] = domain;
    row["address"] = server.address;
    row["port"] = server.port;
    row["place"] = name_of(server.place);
    row["term_ms"] = server.term;
    row["version"] = server.version;
    row["parts"] = or_null(server.parts);
    row["tick_rate_hz"] = or_null(server.tick_rate_hz);
    row["load"] = or_null(load_of(server));
    row["users"] = pulse ? nlohmann::json(pulse->users) : nlohmann::json();
    row["tick"] = pulse ? nlohmann::json(pulse->tick) : nlohmann::json();
    row["tick_p99_us"] = pulse ? nlohmann::json(pulse->tick_p99_us) : nlohmann::json();
    row["missed_deadlines"] = pulse ? nlohmann::json(pulse->missed_deadlines) : nlohmann::json();
    document["servers"].push_back(row);
  }
  // Names may be any bytes.
  return json_text(document) + "\n";
}

std::string nobody_text(const DirectoryCommand& command) {
  const DdsOptions& first = command.places.front();
  std::string where;
  for (const DdsOptions& place : command.places) {
    where += where.empty() ? "domain " : ", ";
    where += std::to_string(place.domain);
    if (place.discovery_port != 0) where += " port " + std::to_string(place.discovery_port);
  }
  return fmt::format("no server {}answered at {} ({}) within {:g} s: {}",
                     first.session == kEverySession ? "" : "of session '" + first.session + "' ",
                     looked_at(first), where, command.wait_s,
                     first.keys.empty() ? "none runs there, or it asks for keys (--keys)"
                                        : "none runs there, or not with keys of the same site");
}

}  // namespace mortise
