// The generalized depth of random pairs: convex ones against their exact depth, others against a
// longer search.
#include <algorithm>
#include <cmath>

#include "tests/bench/gpd_ask.h"
#include "tests/bench/judgement_sections.h"
#include "tests/bench/statistics.h"

namespace mortise::bench {
namespace {

struct GpdTally {
  long long pairs = 0, endless = 0, not_apart = 0, close = 0, above = 0;
  std::vector<double> time_ms, off_mm, long_by, lower;

  void add(const GpdWord& word, double truth_mm, double beyond_mm) {
    ++pairs;
    const Interval& gpd = word.depth.gpd_mm;
    endless += !std::isfinite(gpd.hi);
    not_apart += !word.apart;
    close += gpd.hi <= 1.01 * truth_mm + 2e-6;
    above += std::max(gpd.lo, beyond_mm) > truth_mm * (1.0 + 1e-9) + 2e-7;
    time_ms.push_back(1e3 * word.time_s);
    off_mm.push_back(std::max(std::fabs(gpd.lo - truth_mm), std::fabs(gpd.hi - truth_mm)));
    if (truth_mm > 0.0) {
      long_by.push_back(gpd.hi / truth_mm);
      lower.push_back(gpd.lo / truth_mm);
    }
  }
  void tell(Report& report, const std::string& what) const {
    report.row({what, pairs, endless, not_apart, close, above, largest(off_mm), largest(long_by),
                median(lower), median(time_ms), quantile(time_ms, 0.9)});
  }
};

}  // namespace

void section_gpd(Report& report, const JudgementOptions& options) {
  const long long convex = options.cases > 0 ? options.cases : options.quick ? 1000 : 10'000;
  const long long hollow = options.cases > 0 ? options.cases : options.quick ? 40 : 1000;
  const int effort = options.quick ? 3 : 10;
  GpdTally exact, searched;
  for (long long i = options.from; i < options.from + convex; ++i) {
    const GpdPair pair = draw_convex_pair(static_cast<std::uint64_t>(i));
    const GpdWord word = ask_gpd(pair, Refinement::kDecided);
    const double truth_mm = std::max(0.0, minkowski_depth_mm(pair));
    exact.add(word, truth_mm, truth_mm > 0.0 ? holds_beyond_mm(pair, word) : 0.0);
  }
  for (long long i = options.from; i < options.from + hollow; ++i) {
    const GpdPair pair = draw_hollow_pair(static_cast<std::uint64_t>(i));
    const GpdWord word = ask_gpd(pair, Refinement::kDecided);
    searched.add(word, search_longer(pair, word, effort), holds_beyond_mm(pair, word));
  }
  report.table("Generalized penetration depth of random pairs",
               {"pairs", "asked", "without a motion", "motions that do not part", "hi within 1 %",
                "lo above", "off by mm at most", "hi over it at most", "lo over it, median", "ms",
                "ms p90"});
  exact.tell(report, "convex, against the exact depth of their Minkowski difference");
  searched.tell(report, "hollow, against a longer search");
  report.bar("gpd, convex pairs, off by mm at most", largest(exact.off_mm), 1e-6,
             BoundKind::kAtMost);
  report.bar("gpd, hollow pairs within 1 %, share",
             static_cast<double>(searched.close) / static_cast<double>(searched.pairs), 0.99,
             BoundKind::kAtLeast);
  report.bar(
      "gpd, motions that do not part, or none",
      static_cast<double>(exact.endless + exact.not_apart + searched.endless + searched.not_apart),
      0.0, BoundKind::kAtMost);
  report.bar("gpd, lower ends above the truth", static_cast<double>(exact.above + searched.above),
             0.0, BoundKind::kAtMost);
  report.bar("gpd of hollow pairs, ms, median", median(searched.time_ms), 1.5, BoundKind::kAtMost);
  report.bar("gpd of hollow pairs, ms, p90", quantile(searched.time_ms, 0.9), 4.0,
             BoundKind::kAtMost);
}

}  // namespace mortise::bench
