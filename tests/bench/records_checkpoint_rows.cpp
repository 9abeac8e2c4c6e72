// What a checkpoint of a large scene takes from the ticks beside which it is made.
#include <algorithm>

#include "tests/bench/records_sections.h"
#include "tests/bench/statistics.h"
#include "tests/support/ball_bed.h"

namespace mortise::bench {
namespace {

using test::BallBed;

constexpr double kTickBar_ms = 0.5;

struct Cost {
  std::vector<double> begin, slice, end, none;  ///< CPU of a tick, s, by what it had to do
  long long checkpoints = 0;
};

// As the server records a tick.
Cost record_ticks(BallBed& bed, SessionLogWriter& log, int ticks, int every) {
  Cost cost;
  CheckpointMaker maker;
  maker.begin(bed.world());
  bool running = false;
  for (int i = 1; i <= ticks; ++i) {
    bed.tick();
    const bool due = i % every == 0;
    const Stopwatch watch;
    TickRecord record = log.spare();
    record.tick = bed.report().tick;
    record.time_ns = static_cast<std::int64_t>(i) * 16'666'667;
    record.increments = bed.increments();
    record.report = bed.report();
    record.state = maker.after_tick(bed.world(), due);
    const bool ended = static_cast<bool>(record.state);
    log.record(std::move(record));
    const double took_s = watch.elapsed_s();
    (ended              ? cost.end
     : due && !running ? cost.begin
     : running         ? cost.slice
                       : cost.none)
        .push_back(took_s);
    running = (running || due) && !ended;
    cost.checkpoints += ended;
  }
  return cost;
}

}  // namespace

void section_checkpoint(Report& report, const RecordsOptions& options) {
  report.table("Recording a tick of balls that all move, beside the making of checkpoints, CPU us",
               {"moved", "pairs", "checkpoints", "tick without", "begins", "goes on", "ends",
                "worst of all"});
  for (const int side : options.quick ? std::vector<int>{18} : std::vector<int>{18, 42}) {
    BallBed bed(side);
    const ScratchFile file("balls.mcap");
    auto log = SessionLogWriter::create(file.path(), bed.header());
    if (!log) return report.note("no log could be written: " + log.error().text);
    const Cost cost = record_ticks(bed, **log, options.quick ? 700 : 1400, 170);
    static_cast<void>((*log)->close());
    const auto worst_us = [](const std::vector<double>& s) {
      return s.empty() ? 0.0 : 1e6 * largest(s);
    };
    const double worst = std::max({worst_us(cost.begin), worst_us(cost.slice), worst_us(cost.end)});
    report.row({static_cast<long long>(side) * side, static_cast<long long>(bed.pairs()),
                cost.checkpoints, 1e6 * median(cost.none), worst_us(cost.begin),
                worst_us(cost.slice), worst_us(cost.end), worst});
    report.bar("a checkpoint among " + std::to_string(bed.pairs()) +
                   " pairs, longest CPU time of any tick, ms",
               1e-3 * worst, kTickBar_ms, BoundKind::kAtMost);
  }
}

}  // namespace mortise::bench
