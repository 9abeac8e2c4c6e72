#pragma once
#include <string>
#include <vector>

#include "tests/bench/report.h"

namespace mortise::bench {

struct Options {
  std::string json_file, plot_file;  ///< empty: not written
  std::vector<std::string> only;     ///< names of sections; empty: all
  bool quick = false;                ///< fewer queries; the figures are rougher
};

/// Each adds its tables, notes and bars to the report.
void section_rows(Report& report, const Options& options);
void section_distance(Report& report, const Options& options);
void section_build(Report& report, const Options& options);
void section_triangles(Report& report, const Options& options);
void section_threads(Report& report, const Options& options);
void section_tick(Report& report, const Options& options);

struct Section {
  const char* name;
  const char* asks;  ///< one line for --help
  void (*run)(Report&, const Options&);
};
const std::vector<Section>& sections();

}  // namespace mortise::bench
