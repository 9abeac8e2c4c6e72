#pragma once
#include <string>
#include <vector>

#include "tests/bench/report.h"

namespace mortise::bench {

struct SessionOptions {
  std::string json_file;          ///< empty: not written
  std::vector<std::string> only;  ///< names of sections; empty: all
  bool quick = false;             ///< shorter runs; the figures are rougher
  bool soak = false;              ///< the load for ten minutes
  double load_seconds() const { return soak ? 600.0 : quick ? 8.0 : 30.0; }
};

/// Each adds its tables, notes and bars to the report.
void section_users(Report& report, const SessionOptions& options);
void section_processes(Report& report, const SessionOptions& options);
void section_tick(Report& report, const SessionOptions& options);
void section_idle(Report& report, const SessionOptions& options);
void section_reader(Report& report, const SessionOptions& options);
void section_join(Report& report, const SessionOptions& options);

struct SessionSection {
  const char* name;
  const char* asks;  ///< one line for --help
  void (*run)(Report&, const SessionOptions&);
};
const std::vector<SessionSection>& session_sections();

}  // namespace mortise::bench
