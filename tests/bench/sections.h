#pragma once
#include <string>
#include <vector>

#include "tests/bench/bench_main.h"

namespace mortise::bench {

struct Options : BenchOptions {
  std::string plot_file;  ///< empty: not drawn
};

/// Each adds its tables, notes and bars to the report.
void section_rows(Report& report, const Options& options);
void section_distance(Report& report, const Options& options);
void section_bounds(Report& report, const Options& options);
void section_build(Report& report, const Options& options);
void section_triangles(Report& report, const Options& options);
void section_threads(Report& report, const Options& options);
void section_tick(Report& report, const Options& options);

using Section = BenchSection<Options>;
const std::vector<Section>& sections();

}  // namespace mortise::bench
