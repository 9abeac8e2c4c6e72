// Convex polyhedra with bands, against linear programs over their offset half-spaces.
#include "tests/bench/judgement_convex.h"
#include "tests/bench/judgement_sections.h"

namespace mortise::bench {
namespace {

const std::string kWay = "plane faces, bands";

}  // namespace

void section_convex(Report& report, const JudgementOptions& options) {
  const long long wanted = options.quick ? 3000 : 100'000;
  const long long count = options.cases > 0 ? options.cases : wanted;
  OracleRun run;
  constexpr int kOrderStride = 5, kFullStride = 4;
  for (long long i = options.from; i < options.from + count; ++i)
    run.add(draw_convex(static_cast<std::uint64_t>(i)),
            {kWay, i % 2 == 1, i % kOrderStride == 0, i % kFullStride == 0});
  run.finish();
  run.add_table(report, "Convex polyhedra against linear programs (columns: truth: word)");
  run.add_bars(report, "convex", wanted, 99.0);
}

void tell_convex_case(std::uint64_t seed) {
  OracleRun run;
  run.add(draw_convex(seed), {kWay, false, true, true, true});
  run.finish();
}

}  // namespace mortise::bench
