// Motions of real parts that fit into each other, as their designers tessellated them.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/base/check.h"
#include "common/io/mesh/obj_exact.h"
#include "tests/bench/scenes.h"
#include "tests/unit/ccd/shapes.h"
#include "tests/unit/ccd/workload.h"

namespace mortise::bench {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;
constexpr double kFileUnit_mm = 1000.0;

/// As the data set states it: where the part sits in the fixed one, and how far from its walls.
struct Fit {
  const char *id, *fixed, *moving;
  double least_z_mm, most_z_mm;  ///< of the part when it is in
  double gap_mm;                 ///< all around
  double pitch_mm;               ///< of a thread; 0: none
};
constexpr Fit kFits[] = {
    {"round8_tight", "insertion/factory_round_hole_8mm_subdiv_3x",
     "insertion/factory_round_peg_8mm_tight", -30.0, 5.0, 0.0519, 0.0},
    {"round16_tight", "insertion/factory_round_hole_16mm_subdiv_3x",
     "insertion/factory_round_peg_16mm_tight", -30.0, 5.0, 0.2526, 0.0},
    {"rect8_tight", "insertion/factory_rectangular_hole_8mm_subdiv_3x",
     "insertion/factory_rectangular_peg_8mm_tight_subdiv_3x", -30.0, 5.0, 0.067, 0.0},
    {"gear_small_on_loose_shaft", "gears/factory_gear_base_loose_space_5e-4_subdiv_4x",
     "gears/factory_gear_small_space_5e-4", 0.2, 10.0, 0.0127, 0.0},
    {"m16_loose", "nut_bolt/factory_bolt_m16_loose", "nut_bolt/factory_nut_m16_loose_subdiv_3x",
     2.0, 10.0, 0.1, 2.0},
};

bool load(const std::string& name, TriangleMesh& mesh) {
  auto read = read_obj_exact(testing::data_folder() + "/fits/" + name + ".obj", kFileUnit_mm);
  if (!read) return false;
  mesh = std::move(read.value().mesh);
  return true;
}

// Both are moved so that the part's axis is z and it turns about the middle of its height.
void centre(TriangleMesh& moving, TriangleMesh& fixed, double& height_mm) {
  Box box;
  for (const Vec3& p : moving.points_mm) box.add(p);
  const Vec3 middle = box.center();
  for (Vec3& p : moving.points_mm) p -= middle;
  for (Vec3& p : fixed.points_mm) p -= middle;
  height_mm = box.hi.z() - box.lo.z();
}

/// Inserted at z (turned along, on a thread), a little off the middle.
Pose inserted(const Fit& fit, Dice& dice) {
  const double z = dice.between(fit.least_z_mm, fit.most_z_mm);
  // The data set gives the nut at whole turns.
  const double turn = fit.pitch_mm > 0.0 ? 2.0 * kPi * z / fit.pitch_mm : 0.0;
  const double off = fit.pitch_mm > 0.0 ? 0.0 : 0.25 * fit.gap_mm;
  return testing::turn({0, 0, std::remainder(turn, 2.0 * kPi)},
                       {dice.between(-off, off), dice.between(-off, off), z});
}

Motion motion_of(const Fit& fit, Dice& dice, int i, double top_mm, double height_mm) {
  const double angle = kDegree * dice.sign() * dice.between(0.5, 5.0);
  const double around = dice.between(0.0, 2.0 * kPi);
  const Vec3 aside(std::cos(around), std::sin(around), 0.0);
  const Vec3 down(0, 0, -1);
  if (i % 4 == 3) {  // from above
    const Vec3 p = dice.between(0.0, 1.0) * aside +
                   Vec3(0, 0, top_mm + 0.5 * height_mm + dice.between(0.5, 6.0));
    const Pose X0 = testing::turn(kDegree * dice.between(0.0, 3.0) * dice.direction(), p);
    return linear_motion(X0, turned(X0, angle * dice.direction(), dice.between(3.0, 10.0) * down),
                         Vec3::Zero());
  }
  const Pose X0 = inserted(fit, dice);
  if (i % 4 == 1)  // pushed aside
    return linear_motion(X0,
                         turned(X0, 0.2 * angle * dice.direction(), dice.between(0.5, 5.0) * aside),
                         Vec3::Zero());
  if (fit.pitch_mm > 0.0) {  // along the thread, or off it
    const double error_mm = i % 4 == 2 ? dice.between(-0.5, 0.5) : 0.0;
    const Vec3 lift(0, 0, fit.pitch_mm * angle / (2.0 * kPi) + error_mm);
    return screw_motion(X0, turned(X0, {0, 0, angle}, lift), Vec3::Zero());
  }
  const bool spins = i % 4 == 2;
  const Vec3 way = (spins ? dice.between(0.0, 3.0) : dice.between(1.0, 10.0)) * down;
  return linear_motion(X0, turned(X0, {0, 0, spins ? angle : 0.0}, way), Vec3::Zero());
}

}  // namespace

const std::vector<std::string>& fit_ids() {
  static const std::vector<std::string> ids = [] {
    std::vector<std::string> all;
    for (const Fit& fit : kFits) all.emplace_back(fit.id);
    return all;
  }();
  return ids;
}

MotionSet fit_set(const std::string& id, int count) {
  MotionSet set;
  for (const Fit& fit : kFits) {
    TriangleMesh moving, fixed;
    if (id != fit.id || !load(fit.moving, moving) || !load(fit.fixed, fixed)) continue;
    double height_mm = 0.0;
    centre(moving, fixed, height_mm);
    set.name = "real parts: " + id;
    set.moving = testing::solid(std::move(moving));
    set.fixed = testing::solid(std::move(fixed));
    set.truth = TruthSource::kFinest;
    const double top_mm = set.fixed->bounds().hi.z();
    Dice dice(108);
    fill(set, count, [&](int i) { return motion_of(fit, dice, i, top_mm, height_mm); });
  }
  return set;
}

}  // namespace mortise::bench
