// Server and bots as programs on loopback, with the demo scene: latency, losses, deadlines, memory.
#include <fmt/format.h>

#include "tests/bench/session_load.h"
#include "tests/bench/session_sections.h"

namespace mortise::bench {
namespace {

constexpr double kMissedBar_percent = 0.5;
constexpr double kMemoryBar_mb_per_h = 1.0;
constexpr double kWarmBar_mb = 40.0;  // what it took to get warm does not count as growth
constexpr double kBeyondTickBar_ms = 5.0;
constexpr double kManyMissedBar_percent = 0.1;        // of 64 processes; of 16 none is missed
constexpr double kTickBars_ms[3] = {0.5, 4.0, 10.0};  // of 64 users: p50, p99, max
constexpr double kTickAndWay_ms = 21.7;               // a tick of 60 Hz, and 5 ms
constexpr double kBeatAndWay_ms = 13.3;               // a beat of 120 Hz, and 5 ms
constexpr double kManyProcesses_s = 15.0;

const std::vector<std::string> kColumns = {"behaviour",
                                           "processes",
                                           "users",
                                           "rate Hz",
                                           "seconds",
                                           "increments",
                                           "to pose p50 ms",
                                           "to pose p90 ms",
                                           "to pose p99 ms",
                                           "to pose max ms",
                                           "to event p50 ms",
                                           "to event p99 ms",
                                           "tick p50 us",
                                           "tick p99 us",
                                           "tick max us",
                                           "missed %",
                                           "ran over %",
                                           "lost events",
                                           "resyncs",
                                           "missed pose batches",
                                           "lost commands",
                                           "lost increments",
                                           "streams differing",
                                           "load average"};

std::string name_of(const LoadShape& shape) {
  return shape.processes == 1
             ? fmt::format("{} users at {:g} Hz", shape.users, shape.rate_hz)
             : fmt::format("{} processes at {:g} Hz", shape.processes, shape.rate_hz);
}

// The same with hands that tremble where parts stand apart: what wire and server take without the
// engine. Reported beside.
LoadShape in_free_air(LoadShape shape, const SessionOptions& options) {
  shape.behaviour = "shake";
  shape.seconds = options.quick ? 5.0 : 15.0;
  return shape;
}

LoadResult row(Report& report, const LoadShape& shape) {
  LoadResult r = run_load(shape);
  if (!r.ran) {
    report.note(name_of(shape) + " did not run: " + r.why_not);
    return r;
  }
  const Json &b = r.bots, &tick_us = r.server["times_us"]["tick"];
  const auto count = [&](const Json& value) { return static_cast<long long>(value.get<double>()); };
  report.row({shape.behaviour,
              static_cast<long long>(shape.processes),
              static_cast<long long>(shape.processes * shape.users),
              shape.rate_hz,
              shape.seconds,
              count(b["sent"]),
              r.at("latency_ms", "p50"),
              r.at("latency_ms", "p90"),
              r.at("latency_ms", "p99"),
              r.at("latency_ms", "max"),
              r.at("event_latency_ms", "p50"),
              r.at("event_latency_ms", "p99"),
              tick_us["p50"].get<double>(),
              tick_us["p99"].get<double>(),
              tick_us["max"].get<double>(),
              r.missed_percent,
              r.ran_over_percent,
              count(b["lost"]["events"]),
              count(b["repaired"]["resyncs"]),
              count(b["lost"]["pose_batches"]),
              static_cast<long long>(r.lost_commands),
              static_cast<long long>(r.lost_increments),
              b.contains("streams") ? count(b["streams"]["differing_blocks"]) : 0LL,
              fmt::format("{:.1f} to {:.1f}", r.load_average_before, r.load_average_after)});
  return r;
}

void latency_bar(Report& report, const LoadShape& shape, const LoadResult& r, double most_ms) {
  report.bar(fmt::format("{}: increment to pose p99, ms (at most {:g})", name_of(shape), most_ms),
             r.ran ? r.at("latency_ms", "p99") : std::nan(""), most_ms, BoundKind::kAtMost);
}

void tick_bars(Report& report, const LoadShape& shape, const LoadResult& r) {
  const char* const names[3] = {"p50", "p99", "max"};
  for (int i = 0; i < 3; ++i)
    report.bar(fmt::format("{}: tick {}, ms", name_of(shape), names[i]),
               r.ran ? 1e-3 * r.server["times_us"]["tick"][names[i]].get<double>() : std::nan(""),
               kTickBars_ms[i], BoundKind::kAtMost);
}

void missed_bar(Report& report, const LoadShape& shape, const LoadResult& r, double most_percent) {
  report.bar(fmt::format("{}: deadlines missed, % (at most {:g})", name_of(shape), most_percent),
             r.ran ? r.missed_percent : std::nan(""), most_percent, BoundKind::kAtMost);
}

void bars(Report& report, const LoadShape& shape, const LoadResult& r,
          const SessionOptions& options) {
  const std::string name = name_of(shape);
  const auto bar = [&](const std::string& what, double figure, double bound) {
    report.bar(name + ": " + what, r.ran ? figure : std::nan(""), bound, BoundKind::kAtMost);
  };
  const auto number = [&](auto read) { return r.ran ? static_cast<double>(read()) : 0.0; };
  bar("lost events after resync", number([&] { return r.bots["lost"]["events"].get<double>(); }),
      0.0);
  bar("lost acknowledged commands", number([&] { return r.lost_commands; }), 0.0);
  bar("lost acknowledged increments", number([&] { return r.lost_increments; }), 0.0);
  bar("deadlines missed, %", r.missed_percent, kMissedBar_percent);
  if (r.ran && r.bots.contains("streams")) {
    bar("blocks of the event stream that differ between participants",
        r.bots["streams"]["differing_blocks"].get<double>(), 0.0);
  }
  if (!r.ran) return;
  report.note(fmt::format(
      "{}: server memory {:.1f} to {:.1f} MB over {:.0f} s after warm-up, {:+.1f} MB/h; one page "
      "more would show as {:.2f} MB/h{}",
      name, r.memory.first_mb, r.memory.last_mb, r.memory.seconds, r.memory.mb_per_h,
      r.memory.resolution_mb_per_h,
      options.soak
          ? fmt::format("; {:.1f} to {:.1f} MB over the last {:.0f} s of the warm-up, {:+.1f} MB/h",
                        r.memory_of_warm_up.first_mb, r.memory_of_warm_up.last_mb,
                        r.memory_of_warm_up.seconds, r.memory_of_warm_up.mb_per_h)
          : ": too short to tell a slope of 1 MB/h, that is asked of --soak"));
  if (!options.soak) return;
  bar("server memory slope, MB/h", r.memory.mb_per_h, kMemoryBar_mb_per_h);
  bar("memory of the warm server, MB", r.memory.first_mb, kWarmBar_mb);
}

}  // namespace

void section_users(Report& report, const SessionOptions& options) {
  report.table("One process with many users, demo scene, loopback", kColumns);
  const LoadShape shape{1, 64, 60.0, options.load_seconds(), options.warm_up_seconds()};
  const LoadResult result = row(report, shape);
  if (!options.soak) row(report, in_free_air(shape, options));
  bars(report, shape, result, options);
  tick_bars(report, shape, result);
  latency_bar(report, shape, result, kTickAndWay_ms);
}

void section_processes(Report& report, const SessionOptions& options) {
  report.table("Many client processes, demo scene, loopback", kColumns);
  const LoadShape asked{16, 1, 120.0, options.load_seconds(), options.warm_up_seconds()};
  const LoadResult result = row(report, asked);
  bars(report, asked, result, options);
  const double tick_ms = result.ran ? 1e3 / result.server["tick_rate_hz"].get<double>() : 0.0;
  report.bar("16 processes at 120 Hz: increment to pose p99, ms",
             result.ran ? result.at("latency_ms", "p99") : std::nan(""),
             tick_ms + kBeyondTickBar_ms, BoundKind::kAtMost);
  missed_bar(report, asked, result, 0.0);
  latency_bar(report, asked, result, kBeatAndWay_ms);
  if (options.soak) return;
  row(report, in_free_air(asked, options));
  const double seconds = options.quick ? 5.0 : kManyProcesses_s;
  row(report, {32, 1, 120.0, seconds});  // reported only
  const LoadShape many{64, 1, 120.0, seconds};
  const LoadResult of_many = row(report, many);
  missed_bar(report, many, of_many, kManyMissedBar_percent);
  latency_bar(report, many, of_many, kTickAndWay_ms);
}

}  // namespace mortise::bench
