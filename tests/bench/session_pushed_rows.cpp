// Pegs in their holes, all pushed at once, and dowels shaken in wide bores: whether everybody gets
// on, and what a tick costs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tests/bench/pushed_pegs.h"
#include "tests/bench/session_sections.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

constexpr double kFewBar = 0.9, kManyBar = 0.5, kAwayBar = 99.0, kThreadsBar = 1.7;
constexpr int kFew = 64;
// A peg that moves less than this share of one alone is stuck.
constexpr double kStuck = 0.1;
constexpr Fit kClearance{"0.1 mm clearance", 19.9, ""};
constexpr Fit kSliding{"H7/g6", 20.0, "Ø20 H7/g6"};
constexpr Fit kLoose{"1 mm clearance", 19.0, ""};

void pushed_rows(Report& report, const Fit& fit, const char* policy, int ticks) {
  double alone_mm = 0.0;
  for (const int count : {1, 8, 32, 64, 256}) {
    const Pushed p = push_all(fit, count, policy, ticks);
    if (count == 1) alone_mm = p.mm_a_tick;
    const double share = p.mm_a_tick / alone_mm, least = p.least_mm_a_tick / alone_mm;
    report.row({std::string(fit.name), std::string(policy), static_cast<long long>(count),
                p.mm_a_tick, share, least, static_cast<long long>(p.not_examined),
                median(p.tick_ms), quantile(p.tick_ms, 0.99), largest(p.tick_ms)});
    if (count == 1) continue;
    const std::string of = fmt::format("{}, {}, {} pegs: ", fit.name, policy, count);
    report.bar(of + "mm a tick beside one alone", share, count <= kFew ? kFewBar : kManyBar,
               BoundKind::kAtLeast);
    report.bar(of + "the slowest peg beside one alone", least, kStuck, BoundKind::kAtLeast);
    if (count <= kFew)
      report.bar(of + "not examined", static_cast<double>(p.not_examined), 0.0, BoundKind::kAtMost);
  }
}

// The same ticks on one thread and on two, in turns; the shortest of each counts, since others work
// on this machine.
void thread_rows(Report& report, const Fit& fit, const char* policy, int ticks) {
  constexpr int kMany = 256, kTurns = 3;
  double wall_s[2] = {kInfinity, kInfinity};
  double moved_mm[2] = {0.0, 0.0};
  for (int turn = 0; turn < kTurns; ++turn)
    for (const int threads : {1, 2}) {
      const Pushed p = push_all(fit, kMany, policy, ticks, threads);
      wall_s[threads - 1] = std::min(wall_s[threads - 1], p.wall_s);
      moved_mm[threads - 1] = p.mm_a_tick;
    }
  const double times = wall_s[0] / wall_s[1];
  report.row({std::string(fit.name), std::string(policy), 1e3 * wall_s[0] / ticks,
              1e3 * wall_s[1] / ticks, times});
  const std::string of = fmt::format("{}, {}, {} pegs: ", fit.name, policy, kMany);
  report.bar(of + "two threads, times as fast as one", times, kThreadsBar, BoundKind::kAtLeast);
  report.bar(of + "mm a tick that differ by threads", std::fabs(moved_mm[0] - moved_mm[1]), 0.0,
             BoundKind::kAtMost);
}

}  // namespace

void section_pushed(Report& report, const SessionOptions& options) {
  const int ticks = options.quick ? 60 : 240;
  report.table("Pegs in their holes, all pushed at once; one thread; ms of CPU a tick",
               {"fit", "policy", "pegs", "mm a tick and peg", "beside one alone", "slowest peg",
                "not examined", "ms median", "ms p99", "ms largest"});
  for (const Fit& fit : {kClearance, kSliding})
    for (const char* policy : {"stop", "slide"}) pushed_rows(report, fit, policy, ticks);
  report.table("256 pegs, all pushed at once; wall time a tick, ms",
               {"fit", "policy", "one thread", "two threads", "times as fast"});
  for (const Fit& fit : {kClearance, kSliding})
    for (const char* policy : {"stop", "slide"}) thread_rows(report, fit, policy, ticks);
  report.table("Dowels of Ø19 shaken in bores of Ø20, stop; one thread; ms of CPU a tick",
               {"designers", "pushes away", "carried out %", "not examined", "ms median", "ms p99",
                "ms largest"});
  for (const int users : {1, 8, 64}) {
    const Shaken s = shake_all(kLoose, users, ticks);
    const double share = 100.0 * static_cast<double>(s.carried_out) / static_cast<double>(s.away);
    report.row({static_cast<long long>(users), s.away, share,
                static_cast<long long>(s.not_examined), median(s.tick_ms),
                quantile(s.tick_ms, 0.99), largest(s.tick_ms)});
    report.bar(fmt::format("{} shaken: pushes away carried out, %", users), share, kAwayBar,
               BoundKind::kAtLeast);
  }
}

}  // namespace mortise::bench
