// Distance beside a twin by rectangle swept spheres, and crossing beside FCL's and beside the
// distance: the same poses in turns, one thread, CPU time.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/base/check.h"
#include "common/ccd/distance.h"
#include "common/ccd/start_state.h"
#include "common/generators/generators.h"
#include "tests/bench/rss_twin.h"
#include "tests/bench/scenes.h"
#include "tests/bench/sections.h"
#include "tests/bench/statistics.h"
#include "tests/oracle/fcl_model.h"
#include "tests/unit/ccd/shapes.h"

namespace mortise::bench {
namespace {

SolidPtr part(const std::string& kind, const std::map<std::string, double>& values = {}) {
  auto made = generate(kind, values);
  MORTISE_CHECK(bool(made), "the generator refused");
  return testing::solid(std::move(made.value().mesh));
}

struct Pair {
  std::string name;
  SolidPtr moving, fixed;
  bool counts = true;  ///< for the bar
};

std::vector<Pair> pairs() {
  const SolidPtr tray = part("housing"), cover = part("cover");
  const SolidPtr fine_tray = part("housing", {{"facets", 256}});
  const SolidPtr plate = part("dowel_plate");
  const SolidPtr small = part("block", {{"x_mm", 12}, {"y_mm", 8}, {"z_mm", 5}});
  return {{"tray and cover", cover, tray},
          {"tray and tray", tray, tray},
          {"trays of 256 facets", fine_tray, fine_tray},
          {"tray and plate", plate, tray},
          {"tray and block", small, tray},
          {"plates", plate, plate},
          {"gears, 64 points a flank", gear_solid(20, 64, 0.0), gear_solid(24, 64, 0.0)},
          {"tray and gear", gear_solid(20, 16, 0.0), tray},
          {"nut and bolt", nut_solid(96), bolt_solid(96), false}};
}

bool cross_by_distance(const Pair& pair, const Pose& X, CcdScratch& scratch) {
  return distance(*pair.moving, X, *pair.fixed, {}, scratch, 0.0).within_limit;
}

// Moved together along `way` until `gap_mm` is left.
Pose moved_near(const Pair& pair, const Quat& q, const Vec3& way, double gap_mm) {
  CcdScratch scratch;
  const Vec3 middle = q * pair.moving->sphere().center_mm;
  double apart_mm =
      1.01 * (pair.moving->sphere().radius_mm + pair.fixed->sphere().radius_mm + gap_mm);
  const auto pose = [&] {
    return Pose{q, pair.fixed->sphere().center_mm + apart_mm * way - middle};
  };
  // No step is longer than what is too far.
  for (int k = 0; k < 60; ++k)
    apart_mm -= distance(*pair.moving, pose(), *pair.fixed, {}, scratch).distance_mm - gap_mm;
  return pose();
}

// From anywhere, turned in any way.
std::vector<Pose> poses_apart(const Pair& pair, double gap_mm, int count, Dice& dice) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const Vec3 way = dice.direction();
    poses.push_back(moved_near(pair, dice.orientation(), way, gap_mm));
  }
  return poses;
}

// On top, almost parallel.
std::vector<Pose> poses_on_top(const Pair& pair, double gap_mm, int count, Dice& dice) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const Vec3 way = (Vec3::UnitZ() + 0.05 * dice.direction()).normalized();
    poses.push_back(moved_near(pair, testing::turn(0.002 * dice.direction()).q, way, gap_mm));
  }
  return poses;
}

// Among each other: anywhere within the box of the fixed part where the surfaces do not cross.
std::vector<Pose> poses_within(const Pair& pair, int count, Dice& dice) {
  std::vector<Pose> poses;
  CcdScratch scratch;
  const Box& box = pair.fixed->bounds();
  for (int i = 0; i < 400 * count && static_cast<int>(poses.size()) < count; ++i) {
    Vec3 at;
    for (int c = 0; c < 3; ++c) at[c] = dice.between(box.lo[c], box.hi[c]);
    const Quat q = dice.orientation();
    const Pose X{q, at - q * pair.moving->sphere().center_mm};
    if (!cross_by_distance(pair, X, scratch) && !contained(*pair.moving, X, *pair.fixed, {}, 0.0))
      poses.push_back(X);
  }
  return poses;
}

std::vector<Pose> poses_crossing(const Pair& pair, double deep, int count, Dice& dice) {
  std::vector<Pose> poses;
  CcdScratch scratch;
  for (const Pose& touching : poses_apart(pair, 0.001, 20 * count, dice)) {
    if (static_cast<int>(poses.size()) == count) break;
    const Vec3 middle = touching * pair.moving->sphere().center_mm;
    const Pose X{touching.q, touching.p + deep * (pair.fixed->sphere().center_mm - middle)};
    if (cross_by_distance(pair, X, scratch)) poses.push_back(X);
  }
  return poses;
}

struct Kind {
  const char* name;
  std::vector<Pose> poses;
};

std::vector<Kind> kinds(const Pair& pair, int count) {
  Dice dice(107);
  return {{"0.01 mm apart", poses_apart(pair, 0.01, count, dice)},
          {"1 mm apart", poses_apart(pair, 1.0, count, dice)},
          {"30 mm apart", poses_apart(pair, 30.0, count, dice)},
          {"on top, 0.05 mm", poses_on_top(pair, 0.05, count, dice)},
          {"within", poses_within(pair, count, dice)}};
}

void distances(Report& report, const Options& options, const std::vector<Pair>& all) {
  report.table("Distance at one pose beside rectangle swept spheres: median CPU time",
               {"parts", "poses", "asked", "triangles", "mortise us", "twin us", "FCL us",
                "faster of the two / ours", "differ by mm"});
  std::vector<double> ratios;
  double differ_most_mm = 0.0, overhang_mm = 0.0;
  CcdScratch scratch;
  for (const Pair& pair : all) {
    const RssTwin a(pair.moving->mesh()), b(pair.fixed->mesh());
    overhang_mm = std::max({overhang_mm, a.worst_overhang_mm(), b.worst_overhang_mm()});
    const auto fcl_a = testing::fcl_model(pair.moving->mesh());
    const auto fcl_b = testing::fcl_model(pair.fixed->mesh());
    for (const Kind& kind : kinds(pair, options.quick ? 8 : 32)) {
      if (kind.poses.empty()) continue;
      std::vector<double> ours_s, twin_s, fcl_s;
      double differ_mm = 0.0;
      for (const Pose& X : kind.poses) {
        double ours_mm = 0.0, twin_mm = 0.0;
        ours_s.push_back(least_time_s(
            [&] { ours_mm = distance(*pair.moving, X, *pair.fixed, {}, scratch).distance_mm; }, 20,
            0.002));
        twin_s.push_back(least_time_s([&] { twin_mm = a.distance_mm(X, b, {}); }, 3, 0.004));
        fcl_s.push_back(
            least_time_s([&] { testing::fcl_distance(fcl_a, X, fcl_b, {}); }, 5, 0.004));
        differ_mm = std::max(differ_mm, std::abs(ours_mm - twin_mm));
      }
      const double ratio = std::min(median(twin_s), median(fcl_s)) / median(ours_s);
      if (pair.counts) ratios.push_back(ratio);
      differ_most_mm = std::max(differ_most_mm, differ_mm);
      report.row({pair.name, kind.name, static_cast<long long>(ours_s.size()),
                  std::to_string(pair.moving->mesh().triangles.size()) + " / " +
                      std::to_string(pair.fixed->mesh().triangles.size()),
                  1e6 * median(ours_s), 1e6 * median(twin_s), 1e6 * median(fcl_s), ratio,
                  differ_mm});
    }
  }
  report.bar("distance of trays and gears: time by swept spheres / ours, geometric mean",
             geometric_mean(ratios), 1.5, BoundKind::kAtLeast);
  report.bar("distance of trays and gears: time by swept spheres / ours, least of all rows",
             *std::min_element(ratios.begin(), ratios.end()), 1.5, BoundKind::kAtLeast);
  report.bar("distance of trays and gears: largest difference from the twin, mm", differ_most_mm,
             1e-9, BoundKind::kAtMost);
  report.bar("distance of trays and gears: farthest corner outside its swept sphere, mm",
             overhang_mm, 1e-9, BoundKind::kAtMost);
}

void crossings(Report& report, const Options& options, const std::vector<Pair>& all) {
  report.table("Do the surfaces cross: median CPU time",
               {"parts", "poses", "asked", "mortise us", "by distance us", "FCL us",
                "by distance / ours", "FCL / ours", "disagree"});
  std::vector<double> crossing, apart;
  long long disagree_all = 0;
  CcdScratch scratch;
  for (const Pair& pair : all) {
    const auto fcl_a = testing::fcl_model(pair.moving->mesh());
    const auto fcl_b = testing::fcl_model(pair.fixed->mesh());
    const auto row = [&](const char* kind, const std::vector<Pose>& poses,
                         std::vector<double>& ratios) {
      if (poses.empty()) return;
      std::vector<double> ours_s, twin_s, fcl_s;
      long long disagree = 0;
      for (const Pose& X : poses) {
        bool ours = false, twin = false;
        ours_s.push_back(least_time_s(
            [&] { ours = surfaces_cross(*pair.moving, X, *pair.fixed, {}, scratch); }, 20, 0.001));
        twin_s.push_back(
            least_time_s([&] { twin = cross_by_distance(pair, X, scratch); }, 20, 0.001));
        fcl_s.push_back(
            least_time_s([&] { testing::fcl_collide(fcl_a, X, fcl_b, {}); }, 20, 0.001));
        disagree += ours != twin;
      }
      ratios.push_back(median(fcl_s) / median(ours_s));
      disagree_all += disagree;
      report.row({pair.name, kind, static_cast<long long>(poses.size()), 1e6 * median(ours_s),
                  1e6 * median(twin_s), 1e6 * median(fcl_s), median(twin_s) / median(ours_s),
                  ratios.back(), disagree});
    };
    Dice dice(108);
    const int count = options.quick ? 8 : 32;
    row("just crossing", poses_crossing(pair, 0.01, count, dice), crossing);
    row("deeper", poses_crossing(pair, 0.3, count, dice), crossing);
    row("0.01 mm apart", poses_apart(pair, 0.01, count, dice), apart);
    row("within", poses_within(pair, count, dice), apart);
  }
  report.bar("crossing: FCL's time / ours, geometric mean of crossing poses",
             geometric_mean(crossing), 1.0, BoundKind::kAtLeast);
  report.bar("crossing: FCL's time / ours, geometric mean of poses apart", geometric_mean(apart),
             1.0, BoundKind::kAtLeast);
  report.bar("crossing: answers that differ from those by distance",
             static_cast<double>(disagree_all), 0.0, BoundKind::kAtMost);
}

}  // namespace

void section_bounds(Report& report, const Options& options) {
  const std::vector<Pair> all = pairs();
  distances(report, options, all);
  crossings(report, options, all);
}

}  // namespace mortise::bench
