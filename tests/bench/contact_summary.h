#pragma once
#include <string>
#include <vector>

#include "tests/bench/report.h"
#include "tests/bench/score.h"

namespace mortise::bench {

/// One set of motions and what every method said of it.
struct SetRun {
  MotionSet set;
  std::vector<Asked> asked;
};

const std::vector<std::string>& score_columns();
std::vector<Cell> score_cells(const std::string& name, const Score& score);

/// Every peer on every set.
void ratio_table(Report& report, const std::vector<SetRun>& runs);

/// Every method over all sets, the bars of speed and of correctness, and the picture (empty name:
/// none).
void summary(Report& report, const std::vector<SetRun>& runs, const std::string& plot_file);

}  // namespace mortise::bench
