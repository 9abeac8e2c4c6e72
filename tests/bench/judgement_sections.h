#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/bench_main.h"

namespace mortise::bench {

struct JudgementOptions : BenchOptions {
  std::string plot_file;  ///< empty: not drawn
  long long cases = 0;    ///< 0: as many as the run has by itself
  long long from = 0;     ///< first seed of the sections convex and csg
  std::string one_case;   ///< "cylinder:123": this one, told in full
};

/// Each adds its tables, notes and bars to the report.
void section_truth(Report& report, const JudgementOptions& options);
void section_realization(Report& report, const JudgementOptions& options);
void section_recognition(Report& report, const JudgementOptions& options);
void section_depth(Report& report, const JudgementOptions& options);
void section_speed(Report& report, const JudgementOptions& options);
void section_covers(Report& report, const JudgementOptions& options);
void section_places(Report& report, const JudgementOptions& options);
void section_insertion(Report& report, const JudgementOptions& options);
void section_convex(Report& report, const JudgementOptions& options);
void section_csg(Report& report, const JudgementOptions& options);
void section_gpd(Report& report, const JudgementOptions& options);

using JudgementSection = BenchSection<JudgementOptions>;
const std::vector<JudgementSection>& judgement_sections();

/// Prints truth and every word about one case. False when it is not the name of a case.
bool tell_case(const std::string& name);
/// The same of the pair of a seed.
void tell_convex_case(std::uint64_t seed);
void tell_csg_case(std::uint64_t seed);

}  // namespace mortise::bench
