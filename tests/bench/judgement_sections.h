#pragma once
#include <string>
#include <vector>

#include "tests/bench/report.h"

namespace mortise::bench {

struct JudgementOptions {
  std::string json_file, plot_file;  ///< empty: not written
  std::vector<std::string> only;     ///< names of sections; empty: all
  bool quick = false;                ///< far fewer cases
  long long cases = 0;               ///< 0: as many as the run has by itself
  std::string one_case;              ///< "cylinder:123": this one, told in full
};

/// Each adds its tables, notes and bars to the report.
void section_truth(Report& report, const JudgementOptions& options);
void section_realization(Report& report, const JudgementOptions& options);
void section_recognition(Report& report, const JudgementOptions& options);
void section_depth(Report& report, const JudgementOptions& options);
void section_speed(Report& report, const JudgementOptions& options);
void section_insertion(Report& report, const JudgementOptions& options);

struct JudgementSection {
  const char* name;
  const char* asks;  ///< one line for --help
  void (*run)(Report&, const JudgementOptions&);
};
const std::vector<JudgementSection>& judgement_sections();

/// Prints truth and every word about one case. False when it is not the name of a case.
bool tell_case(const std::string& name);

}  // namespace mortise::bench
