// Distance of two meshes at one pose beside FCL's: the same poses, one thread, CPU time.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/ccd/distance.h"
#include "common/ccd/first_contact.h"
#include "tests/bench/scenes.h"
#include "tests/bench/sections.h"
#include "tests/bench/statistics.h"
#include "tests/oracle/fcl_model.h"
#include "tests/unit/ccd/shapes.h"

namespace mortise::bench {
namespace {

using testing::FclModel;

// A moving part at several poses beside a part at identity.
struct DistanceSet {
  std::string name;
  SolidPtr moving, fixed;
  std::vector<Pose> poses;
};

DistanceSet spheres(const SolidPtr& sphere, const std::string& name, double gap_mm, int count) {
  DistanceSet set{name, sphere, sphere, {}};
  Dice dice(101);
  for (int i = 0; i < count; ++i) {
    const Quat turned = dice.orientation();
    set.poses.push_back({turned, (20.0 + gap_mm) * dice.direction()});
  }
  return set;
}

DistanceSet peg_in_hole(double clearance_mm, int facets, int count) {
  DistanceSet set;
  char name[64];
  std::snprintf(name, sizeof name, "peg in hole, clearance %g, %d facets", clearance_mm, facets);
  set.name = name;
  set.moving = testing::solid(testing::prism_mesh(10.0 - 0.5 * clearance_mm, facets, -12.5, 12.5));
  set.fixed = testing::solid(testing::tube_mesh(10.0, 20.0, facets, -40.0, 40.0));
  Dice dice(102);
  // Aside and tilted by a third of what the hole allows, in phase or not.
  const double aside_mm = 0.15 * clearance_mm, tilt_rad = 0.15 * clearance_mm / 25.0;
  for (int i = 0; i < count; ++i) {
    const Vec3 tilt = tilt_rad * dice.direction() + Vec3(0, 0, 0.01 * clearance_mm * dice.sign());
    set.poses.push_back(
        testing::turn(tilt, aside_mm * dice.direction() + Vec3(0, 0, dice.between(-10.0, 10.0))));
  }
  return set;
}

DistanceSet generated_gears(double gap_mm, int count) {
  DistanceSet set;
  char name[64];
  std::snprintf(name, sizeof name, "generated gears, %g mm apart", gap_mm);
  set.name = name;
  set.moving = gear_solid(20, 64, 0.0);
  set.fixed = gear_solid(24, 64, 0.0);
  Dice dice(103);
  const double middles_mm = 0.5 * (set.moving->bounds().hi - set.moving->bounds().lo +
                                   (set.fixed->bounds().hi - set.fixed->bounds().lo))
                                      .x();
  for (int i = 0; i < count; ++i)
    set.poses.push_back(testing::turn({0.0, 0.0, dice.between(-3.0, 3.0)},
                                      {middles_mm + gap_mm, 0.0, dice.between(-1.0, 1.0)}));
  return set;
}

// Poses along the way of measured motions, at a share of the way to their contact.
DistanceSet on_the_way(const MotionSet& motions, double share) {
  DistanceSet set{motions.name, motions.moving, motions.fixed, {}};
  set.name += share == 0.0 ? ", at the start" : ", almost at contact";
  for (const MotionSet::Item& item : motions.items)
    set.poses.push_back(item.motion.pose_at(share * (item.contact ? item.t_contact : 1.0)));
  return set;
}

// Anywhere around each other where they do not cross.
DistanceSet random_poses(const MotionSet& motions, int count) {
  DistanceSet set{motions.name + ", random poses", motions.moving, motions.fixed, {}};
  Dice dice(104);
  CcdScratch scratch;
  const double reach_mm = 1.2 * (set.moving->sphere().radius_mm + set.fixed->sphere().radius_mm);
  for (int tries = 0; tries < 100 * count && static_cast<int>(set.poses.size()) < count; ++tries) {
    const Vec3 at = set.fixed->sphere().center_mm + reach_mm * dice.direction();
    const Pose X{dice.orientation(), at};
    if (!surfaces_cross(*set.moving, X, *set.fixed, {}, scratch)) set.poses.push_back(X);
  }
  return set;
}

std::vector<DistanceSet> all_sets(bool quick) {
  const int count = quick ? 4 : 12;
  std::vector<DistanceSet> sets;
  struct Fineness {
    const char* name;
    int around, down;
  };
  for (const Fineness& f : {Fineness{"spheres 1k", 32, 17}, Fineness{"spheres 10k", 100, 51},
                            Fineness{"spheres 100k", 316, 159}}) {
    const SolidPtr sphere = testing::solid(testing::sphere_mesh(10.0, f.around, f.down));
    const std::string name = f.name;
    sets.push_back(spheres(sphere, name + ", near (0.01 mm)", 0.01, count));
    sets.push_back(spheres(sphere, name + ", a tenth of a radius", 1.0, count));
    sets.push_back(spheres(sphere, name + ", one radius", 10.0, count));
    sets.push_back(spheres(sphere, name + ", far (ten radii)", 100.0, count));
  }
  for (const double clearance_mm : {0.5, 0.1})
    for (const int facets : {64, 256}) sets.push_back(peg_in_hole(clearance_mm, facets, count));
  for (const double gap_mm : {0.1, 5.0, 100.0}) sets.push_back(generated_gears(gap_mm, count));
  for (const char* name : {"sphere10k", "peg_c0.50", "peg_c0.10", "gears", "wall"}) {
    const MotionSet motions = measured_set(name, count);
    if (motions.items.empty()) continue;
    sets.push_back(on_the_way(motions, 0.0));
    sets.push_back(on_the_way(motions, 0.99));
    sets.push_back(random_poses(motions, count));
  }
  return sets;
}

// The same pair tick after tick, each answer seeded with the one before.
void seeded_ticks(Report& report, const std::vector<DistanceSet>& sets) {
  report.table("Distance over ticks of 0.01 mm and 0.0005 rad: median CPU time",
               {"poses", "fresh us", "seeded us", "gain", "differ by mm"});
  CcdScratch scratch;
  for (std::size_t k = 0; k < sets.size(); k += 3) {
    const DistanceSet& set = sets[k];
    Dice dice(105);
    std::vector<double> fresh_s, seeded_s;
    double differ_mm = 0.0;
    for (const Pose& start : set.poses) {
      const Pose step = testing::turn(0.0005 * dice.direction(), 0.01 * dice.direction());
      Pose X = start;
      DistanceResult seed;
      for (int tick = 0; tick < 4; ++tick) {
        X = {(step.q * X.q).normalized(), X.p + step.p};
        DistanceResult fresh, seeded;
        fresh_s.push_back(least_time_s(
            [&] { fresh = distance(*set.moving, X, *set.fixed, {}, scratch); }, 5, 0.002));
        const double time_s = least_time_s(
            [&] {
              seeded = distance(*set.moving, X, *set.fixed, {}, scratch,
                                std::numeric_limits<double>::infinity(), &seed);
            },
            5, 0.002);
        if (tick > 0) seeded_s.push_back(time_s);
        differ_mm = std::max(differ_mm, std::abs(fresh.distance_mm - seeded.distance_mm));
        seed = seeded;
      }
    }
    report.row({set.name, 1e6 * median(fresh_s), 1e6 * median(seeded_s),
                median(fresh_s) / median(seeded_s), differ_mm});
  }
}

}  // namespace

void section_distance(Report& report, const Options& options) {
  report.table("Distance at one pose: median CPU time",
               {"poses", "asked", "triangles", "mortise us", "FCL us", "ratio", "differ by mm"});
  std::vector<double> ratios;
  double differ_most_mm = 0.0;
  CcdScratch scratch;
  const std::vector<DistanceSet> sets = all_sets(options.quick);
  for (const DistanceSet& set : sets) {
    const FclModel moving = testing::fcl_model(set.moving->mesh());
    const FclModel fixed = testing::fcl_model(set.fixed->mesh());
    std::vector<double> ours_s, fcl_s;
    double differ_mm = 0.0;
    for (const Pose& X : set.poses) {
      double ours_mm = 0.0, fcl_mm = 0.0;
      ours_s.push_back(least_time_s(
          [&] { ours_mm = distance(*set.moving, X, *set.fixed, {}, scratch).distance_mm; }, 50,
          0.002));
      fcl_s.push_back(
          least_time_s([&] { fcl_mm = testing::fcl_distance(moving, X, fixed, {}); }, 3, 0.01));
      differ_mm = std::max(differ_mm, std::abs(ours_mm - std::max(0.0, fcl_mm)));
    }
    ratios.push_back(median(fcl_s) / median(ours_s));
    differ_most_mm = std::max(differ_most_mm, differ_mm);
    report.row({set.name, static_cast<long long>(set.poses.size()),
                std::to_string(set.moving->mesh().triangles.size()) + " / " +
                    std::to_string(set.fixed->mesh().triangles.size()),
                1e6 * median(ours_s), 1e6 * median(fcl_s), ratios.back(), differ_mm});
  }
  seeded_ticks(report, sets);
  report.bar("distance: FCL's time / ours, least of all rows",
             *std::min_element(ratios.begin(), ratios.end()), 1.0, BoundKind::kAtLeast);
  report.bar("distance: FCL's time / ours, geometric mean", geometric_mean(ratios), 3.0,
             BoundKind::kAtLeast);
  report.bar("distance: largest difference from FCL's, mm", differ_most_mm, 1e-11,
             BoundKind::kAtMost);
}

}  // namespace mortise::bench
