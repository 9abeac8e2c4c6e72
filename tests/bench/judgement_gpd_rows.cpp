// The generalized depth of random pairs: convex ones against their exact depth, others against a
// longer search.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/math/rotation.h"
#include "tests/bench/gpd_ask.h"
#include "tests/bench/judgement_sections.h"
#include "tests/bench/statistics.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

// What is off by more is printed with its seed, mm.
constexpr double kExact_mm = 1e-6;

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

// Parts of 100,000 triangles, mm: two balls, and a slack peg that leans in its bore.
struct LargePair {
  const char* name;
  GpdPair pair;
};
std::vector<LargePair> large_pairs() {
  const SolidPtr ball = shapes::solid(shapes::sphere(10, Vec3::Zero(), 160)),
                 peg = shapes::solid(shapes::peg({9.95, 0, 40, 1000, 48, 0})),
                 plate = shapes::solid(shapes::ring({10, 0, 20, 1000, 24, 0}, 20));
  return {{"two balls of 101,760 triangles", {ball, ball, Pose::translation({0.1, 0.2, 19.5}), {}}},
          {"a peg of 98,000 in a plate of 100,000",
           {peg, plate, {rotation_exp({0.01, 0, 0}), {0, 0, -5}}, {}}}};
}

void large_rows(Report& report) {
  report.table("Generalized penetration depth of large parts, CPU time",
               {"pair", "lo mm", "hi mm", "ms first", "ms again"});
  double worst_ms = 0.0;
  for (const LargePair& large : large_pairs()) {
    const GpdWord first = ask_gpd(large.pair, Refinement::kDecided),
                  again = ask_gpd(large.pair, Refinement::kDecided);
    report.row({std::string(large.name), again.depth.gpd_mm.lo, again.depth.gpd_mm.hi,
                1e3 * first.time_s, 1e3 * again.time_s});
    worst_ms = std::max(worst_ms, 1e3 * again.time_s);
  }
  report.bar("gpd of a pair of 100,000 triangles each, ms", worst_ms, 20.0, BoundKind::kAtMost);
}

}  // namespace

void section_gpd(Report& report, const JudgementOptions& options) {
  const long long convex = options.cases > 0 ? options.cases : options.quick ? 1000 : 10'000;
  const long long hollow = options.cases > 0 ? options.cases : options.quick ? 40 : 1000;
  const int effort = options.quick ? 3 : 10;
  GpdTally exact, searched;
  long long asked_in_full = 0, full_worse = 0;
  for (long long i = options.from; i < options.from + convex; ++i) {
    const GpdPair pair = draw_convex_pair(static_cast<std::uint64_t>(i));
    const GpdWord word = ask_gpd(pair, Refinement::kDecided);
    const double truth_mm = std::max(0.0, minkowski_depth_mm(pair));
    const Interval& gpd = word.depth.gpd_mm;
    if (!(std::max(std::fabs(gpd.lo - truth_mm), std::fabs(gpd.hi - truth_mm)) <= kExact_mm))
      std::fprintf(stderr, "gpd, convex pair %lld: [%.9g, %.9g] told, %.9g true, %zu regions\n", i,
                   gpd.lo, gpd.hi, truth_mm, word.overlap.regions.size());
    exact.add(word, truth_mm, truth_mm > 0.0 ? holds_beyond_mm(pair, word) : 0.0);
  }
  for (long long i = options.from; i < options.from + hollow; ++i) {
    const GpdPair pair = draw_hollow_pair(static_cast<std::uint64_t>(i));
    const GpdWord word = ask_gpd(pair, Refinement::kDecided);
    searched.add(word, search_longer(pair, word, effort), holds_beyond_mm(pair, word));
    if (i % 5 != 0) continue;
    ++asked_in_full;
    full_worse += ask_gpd(pair, Refinement::kFull, &word).depth.gpd_mm.hi >
                  word.depth.gpd_mm.hi * (1.0 + 1e-12);
  }
  report.table("Generalized penetration depth of random pairs",
               {"pairs", "asked", "without a motion", "motions that do not part", "hi within 1 %",
                "lo above", "off by mm at most", "hi over it at most", "lo over it, median", "ms",
                "ms p90"});
  exact.tell(report, "convex, against the exact depth of their Minkowski difference");
  searched.tell(report, "hollow, against a longer search");
  report.bar("gpd, convex pairs, off by mm at most", largest(exact.off_mm), kExact_mm,
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
  report.bar("gpd, " + std::to_string(asked_in_full) + " pairs asked in full, worse than lazily",
             static_cast<double>(full_worse), 0.0, BoundKind::kAtMost);
  report.bar("gpd of hollow pairs, ms, median", median(searched.time_ms), 1.5, BoundKind::kAtMost);
  report.bar("gpd of hollow pairs, ms, p90", quantile(searched.time_ms, 0.9), 4.0,
             BoundKind::kAtMost);
  large_rows(report);
}

}  // namespace mortise::bench
