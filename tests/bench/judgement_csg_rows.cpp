// Unions and differences of simple solids, against their exact membership.
#include "tests/bench/judgement_csg_cases.h"
#include "tests/bench/judgement_sections.h"

namespace mortise::bench {
namespace {

const std::string kDeclared = "declared faces", kRecognized = "recognized faces";
constexpr int kOrderStride = 5, kFullStride = 10, kRecognizedStride = 4;

}  // namespace

void section_csg(Report& report, const JudgementOptions& options) {
  const long long wanted = options.quick ? 300 : 20'000;
  const long long count = options.cases > 0 ? options.cases : wanted;
  OracleRun declared, recognized;
  for (long long i = options.from; i < options.from + count; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    const CsgCase c = draw_csg(seed);
    const bool full = i % kFullStride == 0;
    declared.add(c.asked(seed, false), {kDeclared, i % 2 == 1, i % kOrderStride == 0, full});
    if (!c.by_face && i % kRecognizedStride == 0)
      recognized.add(c.asked(seed, true), {kRecognized, i % 2 == 1, false, full});
  }
  declared.finish();
  recognized.finish();
  declared.add_table(report, "CSG parts against their membership (columns: truth: word)");
  recognized.add_table(report, "The same, faces recognized and the rest estimated");
  declared.add_bars(report, "csg", wanted, 95.0);
  report.bar("csg, recognized or by estimate: contradictions of the truth",
             static_cast<double>(recognized.contradictions()), 0.0, BoundKind::kAtMost);
}

void tell_csg_case(std::uint64_t seed) {
  const CsgCase c = draw_csg(seed);
  OracleRun run;
  run.add(c.asked(seed, false), {kDeclared, false, true, true, true});
  if (!c.by_face) run.add(c.asked(seed, true), {kRecognized, false, true, true, true});
  run.finish();
}

}  // namespace mortise::bench
