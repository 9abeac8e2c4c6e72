#pragma once
#include <string>
#include <vector>

#include "tests/bench/bench_main.h"

namespace mortise::bench {

struct SessionOptions : BenchOptions {
  bool soak = false;  ///< the load for ten minutes more, after it was warm
  double load_seconds() const { return soak ? kSoakWarmUp_s + 600.0 : quick ? 8.0 : 30.0; }
  double warm_up_seconds() const { return soak ? kSoakWarmUp_s : 10.0; }

  /// What a server keeps for ever is there by then: trees of the parts that have met, answers of
  /// all users, memory of the largest searches.
  static constexpr double kSoakWarmUp_s = 480.0;
};

/// Each adds its tables, notes and bars to the report.
void section_users(Report& report, const SessionOptions& options);
void section_processes(Report& report, const SessionOptions& options);
void section_tick(Report& report, const SessionOptions& options);
void section_idle(Report& report, const SessionOptions& options);
void section_reader(Report& report, const SessionOptions& options);
void section_join(Report& report, const SessionOptions& options);
void section_presence(Report& report, const SessionOptions& options);
void section_restart(Report& report, const SessionOptions& options);
void section_scene(Report& report, const SessionOptions& options);
void section_added(Report& report, const SessionOptions& options);
void section_lossy(Report& report, const SessionOptions& options);
void section_security(Report& report, const SessionOptions& options);
void section_guided(Report& report, const SessionOptions& options);
void section_pushed(Report& report, const SessionOptions& options);
void section_plays(Report& report, const SessionOptions& options);

using SessionSection = BenchSection<SessionOptions>;
const std::vector<SessionSection>& session_sections();

}  // namespace mortise::bench
