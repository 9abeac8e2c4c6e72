// Every approach that the paper names, beside ours, in one run. See README.md.
#include "tests/bench/approaches.h"
#include "tests/bench/broad_phase_rows.h"

namespace mortise::bench {

void section_pairs(Report& report, const BenchOptions& options) {
  broad_phase_rows(report, options.quick);
  report.table("What approaches to the pairs cannot say", {"approach", "cannot say"});
  report.row(
      {std::string("dynamic grid"),
       std::string(
           "little of unlike sizes: a large part lies in many cells, small ones crowd one")});
  report.row({std::string("AABB trees"),
              std::string("that a part has not moved since: it is asked again")});
  report.row({std::string("ours"), std::string("which of the pairs collide: boxes only discard")});
}

}  // namespace mortise::bench

int main(int argc, char** argv) {
  using namespace mortise::bench;
  return run_bench<BenchOptions>(
      argc, argv, "Approaches of the paper: time, error, what each cannot say",
      {{"measures", "how much parts overlap, by volume, translation, GPD and overlap",
        section_measures},
       {"contact", "first contact by six approaches", section_contact},
       {"pairs", "which pairs are near, by grid, trees and ours", section_pairs}});
}
