// Convex polyhedra with bands, against linear programs over their offset half-spaces.
#include "tests/bench/judgement_convex.h"
#include "tests/bench/judgement_sections.h"

namespace mortise::bench {

void section_convex(Report& report, const JudgementOptions& options) {
  const long long wanted = options.quick ? 3000 : 100'000;
  const long long count = options.cases > 0 ? options.cases : wanted;
  OracleRun run;
  constexpr int kOrderStride = 5, kFullStride = 4;
  for (long long i = 0; i < count; ++i) {
    const OracleCase c = draw_convex(static_cast<std::uint64_t>(i));
    ask_oracle(c, {"plane faces, bands", i % 2 == 1, i % kOrderStride == 0, i % kFullStride == 0},
               run);
  }
  run.add_table(report, "Convex polyhedra against linear programs (columns: truth: word)");
  report.note("convex: " + std::to_string(run.asked_swapped) +
              " cases were asked in both orders, " + std::to_string(run.asked_again) +
              " in full as well");
  run.add_bars(report, "convex", wanted, 99.0);
}

void tell_convex_case(std::uint64_t seed) {
  OracleRun run;
  ask_oracle(draw_convex(seed), {"plane faces, bands", false, true, true, true}, run);
}

}  // namespace mortise::bench
