#include "server/restore.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <system_error>
#include <tuple>
#include <utility>

#include "common/io/build_info.h"
#include "common/io/log/log_chain.h"
#include "common/io/log/replay.h"
#include "common/session/memory/session_state.h"
#include "common/session/world/decisions.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

// More than the clocks of two hosts of one folder differ.
constexpr auto kFuture = std::chrono::seconds(60);

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

std::vector<fs::path> logs_to_restore(const fs::path& place, const std::string& session,
                                      Newest by) {
  std::error_code error;
  if (!fs::is_directory(place, error)) return {chain_from(place).back()};
  // Names hold the time: the one that was begun last is the last one. A file of the future was
  // written before the clock was set back: it is an old one.
  const fs::file_time_type future = fs::file_time_type::clock::now() + kFuture;
  std::map<std::tuple<bool, fs::file_time_type, std::string>, fs::path> logs;
  for (const fs::directory_entry& entry : fs::directory_iterator(place, error)) {
    if (!is_log_of(entry.path(), session)) continue;
    fs::file_time_type at{};
    if (by == Newest::kWritten) at = fs::last_write_time(entry.path(), error);
    logs[{at < future, at, entry.path().filename().string()}] = entry.path();
  }
  std::vector<fs::path> newest_first;
  for (auto log = logs.rbegin(); log != logs.rend(); ++log) newest_first.push_back(log->second);
  return newest_first;
}

namespace {

// Of the ticks that need not be computed, as the log tells them.
SessionStatistics told_statistics(const SessionLog& log, std::uint64_t up_to) {
  SessionStatistics told;
  if (log.begin) told = log.begin->statistics;
  std::uint64_t last = log.begin ? log.begin->state.tick : 0;
  for (const TickRecord& record : log.ticks) {
    if (record.tick > up_to) break;
    if (record.tick > last + 1) told.add_idle(record.tick - last - 1);
    told.forget_users(record.decisions);
    told.add(record.report);
    last = record.tick;
  }
  for (const Checkpoint& state : log.checkpoints)
    if (state.tick == up_to) told.set_counters(state.counters);
  return told;
}

LogBegin begin_of(World& world, const SessionStatistics& statistics, std::int64_t time_ns) {
  return {{world.tick,
           state_hash(world, *world.state),
           build_fingerprint(),
           {},
           encode_state(world),
           statistics.counters()},
          statistics,
          time_ns};
}

// A log that was closed says how many ticks it holds; one that was not may have lost any number.
std::string missing_at_end(const SessionLog& log, std::uint64_t last_tick) {
  if (std::string cut_off = cut_off_of(log); !cut_off.empty()) return cut_off;
  if (log.complete) return {};
  return "the log was not closed properly; it ends at tick " + std::to_string(last_tick) +
         ", and what came after is not known";
}

}  // namespace

Result<Resumed> resume_from(const SessionLog& log, World& world, int threads, bool all_depart,
                            const std::function<bool()>& stop) {
  Resumed resumed;
  const std::uint64_t from_tick = world.tick;
  resumed.statistics = told_statistics(log, from_tick);
  auto report = replay(
      world, log, threads, [&](const ReplayedTick& tick) { resumed.statistics.add(tick.computed); },
      Agreement::kBitForBit, stop);
  if (!report) return report.error();
  if (report->stopped)
    return fail(Code::kRuntime,
                "stopped while it was played again, at tick " + std::to_string(world.tick));
  if (report->difference) {
    return fail(Code::kMismatch,
                "at tick " + std::to_string(report->difference->tick) +
                    " this engine disagrees with the log (" + report->difference->what + ")" +
                    (report->same_build ? "" : "; the log was written by another build") +
                    "; restore with the build that wrote it, or start the scenario anew");
  }
  resumed.ticks_computed = report->ticks_compared;
  for (const TickRecord& record : log.ticks)
    ++(record.tick <= world.tick ? resumed.ticks : resumed.ticks_left_out);
  resumed.left_out_because = report->not_verifiable;
  resumed.missing_at_end =
      missing_at_end(log, log.ticks.empty() ? world.tick : log.ticks.back().tick);
  if (world.state) resumed.begin = begin_of(world, resumed.statistics, last_time_ns(log));
  if (all_depart) resumed.departures = depart_all(world);
  return resumed;
}

}  // namespace mortise
