// Cost of one query against the number of triangles, and what the trees weigh.
#include <cmath>

#include "common/base/constants.h"
#include "tests/bench/methods.h"
#include "tests/bench/sections.h"
#include "tests/bench/statistics.h"
#include "tests/unit/ccd/shapes.h"

namespace mortise::bench {
namespace {

constexpr int kMotions = 12;

double bytes_a_triangle(const Solid& solid) {
  return static_cast<double>(solid.bvh().bytes()) /
         static_cast<double>(solid.mesh().triangles.size());
}

void row(Report& report, const std::string& name, const MotionSet& set) {
  std::vector<double> time_s;
  for (const Answer& answer : ask_all(ours(set, kAccuracyDefault_mm), set))
    time_s.push_back(answer.time_s);
  report.row({name, static_cast<long long>(set.moving->mesh().triangles.size()),
              static_cast<long long>(set.fixed->mesh().triangles.size()),
              static_cast<long long>(time_s.size()), 1e3 * geometric_mean(time_s),
              1e3 * quantile(time_s, 0.99), bytes_a_triangle(*set.moving)});
}

}  // namespace

void section_triangles(Report& report, const Options& options) {
  report.table("Cost against the number of triangles",
               {"motions", "triangles moving", "triangles fixed", "asked", "geometric mean ms",
                "p99 ms", "bytes of the tree a triangle"});
  // 1. Spheres: the same motions, ever finer. around = 2 down, triangles = 2 around (down - 1).
  for (const int thousand : options.quick ? std::vector<int>{1, 10, 100}
                                          : std::vector<int>{1, 3, 10, 30, 100, 250, 500}) {
    const int down = static_cast<int>(std::lround(std::sqrt(250.0 * thousand))) + 1;
    row(report, "two spheres", sphere_set(2 * (down - 1), down, kMotions));
  }
  // 2. Gears: the corners of the flanks, ever more.
  for (const int flank_points :
       options.quick ? std::vector<int>{4, 64} : std::vector<int>{4, 16, 64, 256})
    row(report, "two gears", gear_set(kMotions, flank_points));
}

}  // namespace mortise::bench
