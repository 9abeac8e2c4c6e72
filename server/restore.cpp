#include "server/restore.h"

#include <algorithm>
#include <system_error>

#include "common/io/replay.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

/// Name of the session that a log file belongs to, as default_log_file() writes it:
/// <session>-YYYYMMDD-HHMMSS[...].mcap.
bool is_log_of(const fs::path& file, const std::string& session) {
  const std::string name = file.filename().string();
  if (file.extension() != ".mcap" || !name.starts_with(session + "-")) return false;
  const std::string stamp = name.substr(session.size() + 1, 15);
  return stamp.size() == 15 && stamp[8] == '-' &&
         std::count_if(stamp.begin(), stamp.end(), [](char c) { return c >= '0' && c <= '9'; }) ==
             14;
}

std::vector<Decision> depart_all(World& world) {
  std::vector<Decision> departures;
  for (const User& user : world.users) {
    if (!user.present) continue;
    Decision decision;
    decision.kind = Decision::Kind::kLivelinessLost;
    decision.user = user.id;
    departures.push_back(std::move(decision));
  }
  for (const Decision& decision : departures) apply_decision(world, decision);
  return departures;
}

}  // namespace

std::optional<fs::path> log_to_restore(const fs::path& place, const std::string& session) {
  std::error_code error;
  if (!fs::is_directory(place, error)) return place;
  std::optional<fs::path> newest;
  for (const fs::directory_entry& entry : fs::directory_iterator(place, error)) {
    if (!is_log_of(entry.path(), session)) continue;
    // Names hold the time: the newest is the last one.
    if (!newest || entry.path().filename() > newest->filename()) newest = entry.path();
  }
  return newest;
}

Result<Resumed> resume_from(const SessionLog& log, World& world, int threads,
                            SessionLogWriter* record, bool all_depart) {
  Resumed resumed;
  const auto on_tick = [&](const ReplayedTick& tick) {
    resumed.statistics.add(tick.computed);
    if (record == nullptr || tick.logged == nullptr) return;
    TickRecord again;
    again.tick = tick.computed.tick;
    again.time_ns = tick.logged->time_ns;
    again.decisions = tick.logged->decisions;
    again.increments = tick.logged->increments;
    again.report = tick.computed;
    record->record(std::move(again));
  };
  auto report = replay(world, log, threads, on_tick);
  if (!report) return report.error();
  if (report->difference) {
    return fail(Code::kMismatch,
                "at tick " + std::to_string(report->difference->tick) +
                    " this engine computes something else than the log tells (" +
                    report->difference->what + ")" +
                    (report->same_build ? "" : "; the log was written by another build") +
                    "; restore with the build that wrote it, or start the scenario anew");
  }
  resumed.ticks = report->ticks_compared;
  resumed.ticks_left_out = report->ticks_logged - report->ticks_compared;
  resumed.left_out_because = report->not_verifiable;
  if (all_depart) resumed.departures = depart_all(world);
  return resumed;
}

}  // namespace mortise
