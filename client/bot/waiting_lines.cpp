#include "client/bot/waiting_lines.h"

#include <fmt/format.h>

#include "common/messages/names.h"

namespace mortise {
namespace {

// A wait of a few ticks ends before anybody has read of it.
constexpr double kTellWaiting_s = 0.5;

std::string name_of_part(const std::map<PartId, KnownPart>& parts, PartId id) {
  const auto at = parts.find(id);
  return at == parts.end() ? "?" : at->second.info.name;
}

}  // namespace

std::vector<std::string> WaitingLines::after_pulse(const SessionPulse& pulse,
                                                   const std::map<PartId, KnownPart>& parts,
                                                   double tick_rate_hz) {
  std::vector<std::string> lines;
  decltype(waits_) waits;
  for (const UnexaminedRow& row : pulse.unexamined) {
    const auto before = waits_.find({row.a, row.b});
    Wait& wait = waits[{row.a, row.b}];
    if (before != waits_.end()) wait = before->second;
    wait.ticks += static_cast<double>(row.ticks);
    if (wait.told || wait.ticks <= kTellWaiting_s * tick_rate_hz) continue;
    wait.told = true;
    lines.push_back(fmt::format("{} × {} {}; it is not reported as clear before it is judged",
                                name_of_part(parts, row.a), name_of_part(parts, row.b),
                                in_words(row.why)));
  }
  waits_ = std::move(waits);
  if (quiet_) lines.clear();
  return lines;
}

}  // namespace mortise
