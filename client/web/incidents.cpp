#include "client/web/incidents.h"

namespace mortise::web {
namespace {

// A line a second of each kind: a flood of bad clients must not fill the disk with messages.
constexpr double kSayEvery_s = 1.0;

}  // namespace

std::string_view name_of(Incident incident) {
  switch (incident) {
    case Incident::kBadRequest:
      return "bad_request";
    case Incident::kSlowRequest:
      return "slow_request";
    case Incident::kWrongHost:
      return "wrong_host";
    case Incident::kWrongOrigin:
      return "wrong_origin";
    case Incident::kWrongToken:
      return "wrong_token";
    case Incident::kTooManyConnections:
      return "too_many_connections";
    case Incident::kTooManyBrowsers:
      return "too_many_browsers";
    case Incident::kOversized:
      return "oversized";
    case Incident::kMalformed:
      return "malformed";
    case Incident::kFlood:
      return "flood";
    case Incident::kStalled:
      return "stalled";
    case Incident::kSilent:
      return "silent";
    case Incident::kTls:
      return "tls";
    case Incident::kCount:
      break;
  }
  return "unknown";
}

void Incidents::note(Incident incident, const std::string& from, const std::string& what,
                     double now_s) {
  Row& row = rows_[index(incident)];
  ++row.count;
  if (now_s - row.said_s < kSayEvery_s) {
    ++row.unsaid;
    return;
  }
  std::string line = from + ": " + what;
  if (row.unsaid > 0) line += " (and " + std::to_string(row.unsaid) + " more of this kind)";
  row.unsaid = 0;
  row.said_s = now_s;
  say_(line);
}

std::map<std::string, std::uint64_t> Incidents::counts() const {
  std::map<std::string, std::uint64_t> counts;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    counts[std::string(name_of(static_cast<Incident>(i)))] = rows_[i].count;
  }
  return counts;
}

}  // namespace mortise::web
