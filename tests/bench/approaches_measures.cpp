// How much two parts overlap, by every measure that the paper names: the situations of its figures,
// and random convex pairs.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/math/rotation.h"
#include "tests/bench/approaches.h"
#include "tests/bench/approaches_pieces.h"
#include "tests/bench/ccd_points.h"
#include "tests/bench/gpd_ask.h"
#include "tests/bench/statistics.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Closed forms where there are any.
struct Truth {
  double volume_mm3 = kNone, translation_mm = kNone, gpd_mm = kNone, delta_mm = kNone;
};

struct Situation {
  std::string name;
  GpdPair pair;  ///< B at the origin
  Pieces a, b;
  Truth truth;
};

Situation boxes(const std::string& name, const Vec3& half_a, const Vec3& half_b, const Vec3& at,
                const Truth& truth) {
  const TriangleMesh a = shapes::box(half_a), b = shapes::box(half_b);
  return {name, {shapes::solid(a), shapes::solid(b), Pose::translation(at), {}}, {a}, {b}, truth};
}

// 40 mm long, 25 mm to go up until it is out of 20.
Situation peg(const std::string& name, double radius_mm, double phase_rad, double volume_mm3,
              double delta_mm) {
  const TriangleMesh a = shapes::peg({radius_mm, 0, 40, 32, 1, phase_rad});
  return {name,
          {shapes::solid(a),
           shapes::solid(shapes::ring({10, 0, 20, 32, 1, 0}, 20)),
           Pose::translation({0, 0, -5}),
           {}},
          {a},
          ring_pieces(10, 20, 0, 20, 32, 0),
          {volume_mm3, 25.0, 25.0, delta_mm}};
}

std::vector<Situation> situations() {
  const double facet = std::numbers::pi / 32, sag = 10.0 * (1.0 - std::cos(facet));
  std::vector<Situation> all;
  all.push_back(peg("1a: a peg in a hole of its diameter, 32 facets each", 10.0, facet,
                    32 * 20 * sag * sag / std::tan(facet), sag));
  all.push_back(peg("a press fit, 20 um in diameter", 10.01, 0.0,
                    20 * 16 * std::sin(2 * facet) * (10.01 * 10.01 - 100.0), 0.01));
  all.push_back(boxes("1b: a block in the edge of another", {10, 10, 10}, {10, 10, 10},
                      {19.9, 15, 0}, {10.0, 0.1, 0.1, 0.1}));
  all.push_back(boxes("2a: two large plates, 5 um", {50, 50, 5}, {50, 50, 5}, {0, 0, 9.995},
                      {50.0, 0.005, 0.005, 0.005}));
  all.push_back(
      boxes("2b: a bar through a slab", {1, 1, 6}, {20, 20, 2}, {0, 0, 1}, {16.0, 7.0, 7.0, 3.0}));
  const TriangleMesh key = shapes::box({3.98, 3, 10});
  all.push_back({"2c: a key turned in its slot",
                 {shapes::solid(key),
                  shapes::solid(shapes::u_slot(10, 4, 8, 5, 0, 30)),
                  {rotation_exp({0, 0, 0.02}), {0, 3.3, 15}},
                  {}},
                 {key},
                 slot_pieces(10, 4, 8, 5, 0, 30),
                 {}});
  return all;
}

struct Approach {
  const char* name;
  const char* unit;
  const char* cannot_say;
  long long asked = 0, gave_up = 0, off = 0;
  std::vector<double> error = {}, time_ms = {};

  void add(double value, double truth, double time_s) {
    ++asked;
    time_ms.push_back(1e3 * time_s);
    gave_up += !std::isfinite(value);
    if (!std::isfinite(value) || !std::isfinite(truth)) return;
    error.push_back(std::fabs(value - truth));
    off += error.back() > 1e-3;
  }
};

struct Approaches {
  Approach volume{"intersection volume, by convex pieces", "mm³",
                  "a length: 5 um of two plates is 50 mm³, a bar through a slab 16"};
  Approach translation{"translational depth, Minkowski sum of convex pieces", "mm",
                       "that a turn frees the key; needs convex pieces"};
  Approach epa{"translational depth of hulls, EPA of libccd", "mm",
               "anything of a hole: hulls have none"};
  Approach gpd{"generalized depth, ours", "mm",
               "one number where parts are hollow: a bracket; how tight a press fit is"};
  Approach delta{"overlap, ours", "mm", "how far a part must go to come out"};
};

// What of a bracket is nearest to the truth: the truth itself where it is within.
double nearest_in(const Interval& bracket, double truth) {
  return std::isfinite(truth) ? std::clamp(truth, bracket.lo, bracket.hi) : bracket.hi;
}

double epa_depth_mm(const GpdPair& pair) {
  std::vector<Vec3> a, b;
  for (const Vec3& x : pair.a->mesh().points_mm) a.push_back(pair.X_WA * x);
  for (const Vec3& x : pair.b->mesh().points_mm) b.push_back(pair.X_WB * x);
  const ccd_t ccd = ccd_of_points();
  ccd_real_t depth = 0.0;
  ccd_vec3_t direction, position;
  return ccdGJKPenetration(&a, &b, &ccd, &depth, &direction, &position) == 0 ? depth : kNone;
}

Interval overlap_mm(const GpdPair& pair) {
  const SurfaceBand band = nominal_band();
  CcdScratch scratch;
  OverlapQuery query;
  query.a = pair.a.get();
  query.b = pair.b.get();
  query.band_a = query.band_b = &band;
  query.X_WA = pair.X_WA;
  query.X_WB = pair.X_WB;
  query.refinement = Refinement::kFull;
  const OverlapResult overlap = find_overlap(query, scratch);  // the deepest first
  return overlap.regions.empty() ? Interval{} : overlap.regions.front().delta_mm;
}

template <class Ask>
double timed(Approach& approach, double truth, const Ask& ask) {
  const Stopwatch watch;
  const double value = ask();
  approach.add(value, truth, watch.elapsed_s());
  return value;
}

void ask_situations(Report& report, Approaches& by) {
  report.table("What the measures say of the paper's figures",
               {"situation", "volume mm³", "translation mm", "GPD at least mm", "GPD at most mm",
                "overlap mm"});
  for (const Situation& s : situations()) {
    const Pieces a = placed(s.a, s.pair.X_WA);
    const double volume =
        timed(by.volume, s.truth.volume_mm3, [&] { return common_volume_mm3(a, s.b); });
    const double translation = timed(by.translation, s.truth.translation_mm, [&] {
      return translational_depth_mm(a, s.b).value_or(kNone);
    });
    timed(by.epa, s.truth.translation_mm, [&] { return epa_depth_mm(s.pair); });
    const GpdWord word = ask_gpd(s.pair, Refinement::kFull);
    const Interval& gpd = word.depth.gpd_mm;
    by.gpd.add(nearest_in(gpd, s.truth.gpd_mm), s.truth.gpd_mm, word.time_s);
    Interval delta;
    timed(by.delta, s.truth.delta_mm, [&] {
      delta = overlap_mm(s.pair);
      return nearest_in(delta, s.truth.delta_mm);
    });
    report.row({s.name, volume, translation, gpd.lo, gpd.hi, delta.lo});
  }
}

void ask_random(Approaches& by, long long pairs) {
  for (long long seed = 0; seed < pairs; ++seed) {
    const GpdPair pair = draw_convex_pair(static_cast<std::uint64_t>(seed));
    const double exact = std::max(0.0, minkowski_depth_mm(pair));
    const Pieces a = placed({pair.a->mesh()}, pair.X_WA), b = placed({pair.b->mesh()}, pair.X_WB);
    timed(by.volume, kNone, [&] { return common_volume_mm3(a, b); });
    timed(by.translation, exact, [&] { return translational_depth_mm(a, b).value_or(kNone); });
    timed(by.epa, exact, [&] { return epa_depth_mm(pair); });
    const GpdWord word = ask_gpd(pair, Refinement::kDecided);
    by.gpd.add(word.depth.gpd_mm.hi, exact, word.time_s);
    timed(by.delta, kNone, [&] { return overlap_mm(pair).hi; });
  }
}

}  // namespace

void section_measures(Report& report, const BenchOptions& options) {
  Approaches by;
  ask_situations(report, by);
  ask_random(by, options.quick ? 100 : 1000);
  report.table(
      "Approaches to the extent of a collision: the paper's figures and random convex pairs",
      {"approach", "asked", "gave up", "off by 1e-3", "error at most", "unit", "ms median",
       "ms p90", "cannot say"});
  for (const Approach* approach : {&by.volume, &by.translation, &by.epa, &by.gpd, &by.delta})
    report.row({std::string(approach->name), approach->asked, approach->gave_up, approach->off,
                largest(approach->error), std::string(approach->unit), median(approach->time_ms),
                quantile(approach->time_ms, 0.9), std::string(approach->cannot_say)});
  report.bar("generalized depth and overlap, off their closed forms, mm",
             std::max(largest(by.gpd.error), largest(by.delta.error)), 1e-6, BoundKind::kAtMost);
}

}  // namespace mortise::bench
