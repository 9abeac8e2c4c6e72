#include "tests/bench/scenes.h"
#include "common/ccd/start_state.h"

#include <cmath>
#include <numbers>

#include "common/base/check.h"
#include "common/ccd/distance.h"
#include "common/ccd/first_contact.h"
#include "common/generators/generators.h"
#include "tests/unit/ccd/shapes.h"
#include "tests/unit/ccd/workload.h"

namespace mortise::bench {
namespace {

using namespace testing;

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;
constexpr double kPitch_mm = 2.0;
constexpr double kShank_mm = 10.0;
constexpr int kBoltTurns = 10, kNutTurns = 6;

// Motions that start in contact have no first contact to find.
bool starts_free(const MotionSet& set, const Pose& X_W0) {
  CcdScratch scratch;
  return distance(*set.moving, X_W0, *set.fixed, {}, scratch).distance_mm > 1e-6 &&
         !contained(*set.moving, X_W0, *set.fixed, {}, 0.0);
}

bool add(MotionSet& set, const Motion& motion) {
  if (!starts_free(set, motion.X_W0)) return false;
  double radius_mm = 0.0;
  for (const Vec3& p : set.moving->mesh().points_mm) radius_mm = std::max(radius_mm, p.norm());
  MotionSet::Item item;
  item.motion = motion;
  item.speed_mm = motion.travel_upper_bound_mm(radius_mm, 0.0, 1.0);
  set.items.push_back(item);
  return true;
}

SolidPtr generated(const std::string& kind, const std::map<std::string, double>& values) {
  auto part = generate(kind, values);
  MORTISE_CHECK(bool(part), "the generator refused");
  return solid(std::move(part.value().mesh));
}

// Open ribbon: three lines, the middle one on the other radius.
TriangleMesh ribbon(double edge_radius, double middle_radius, int turns, int segments) {
  TriangleMesh mesh;
  const int count = turns * segments;
  for (int i = 0; i <= count; ++i)
    for (int line = -1; line <= 1; ++line) {
      const double angle = 2.0 * kPi * i / segments;
      const double r = line == 0 ? middle_radius : edge_radius;
      mesh.points_mm.push_back({r * std::cos(angle), r * std::sin(angle),
                                kPitch_mm * (static_cast<double>(i) / segments + 0.45 * line)});
    }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i)
    for (std::uint32_t line = 0; line < 2; ++line) {
      const std::uint32_t a = 3 * i + line;
      mesh.triangles.push_back({a, a + 1, a + 4});
      mesh.triangles.push_back({a, a + 4, a + 3});
    }
  return mesh;
}

/// On the thread: turned by `turn_rad` and lifted to match, but for `error_mm`.
Motion on_thread(const Pose& X_W0, double turn_rad, const Vec3& error_mm) {
  const Vec3 lift(0, 0, kPitch_mm * turn_rad / (2.0 * kPi));
  return screw_motion(X_W0, turned(X_W0, {0, 0, turn_rad}, lift + error_mm), Vec3::Zero());
}

Pose engaged(Dice& dice, double least_turns, double most_turns, double play_mm) {
  const double turns = dice.between(least_turns, most_turns);
  const Vec3 play(dice.between(-play_mm, play_mm), dice.between(-play_mm, play_mm),
                  dice.between(-play_mm, play_mm));
  return turn({0, 0, std::remainder(2.0 * kPi * turns, 2.0 * kPi)},
              Vec3(0, 0, kPitch_mm * turns) + play);
}

}  // namespace

void fill(MotionSet& set, int count, const std::function<Motion(int)>& make) {
  for (int tries = 0; static_cast<int>(set.items.size()) < count; ++tries) {
    MORTISE_CHECK(tries < 100 * count, "a scene whose parts nearly always start in contact");
    add(set, make(static_cast<int>(set.items.size())));
  }
}

Pose turned(const Pose& X, const Vec3& rotation_rad, const Vec3& shift_mm) {
  return {(rotation_exp(rotation_rad) * X.q).normalized(), X.p + shift_mm};
}

double Dice::spread(double a, double b) { return std::exp(between(std::log(a), std::log(b))); }

Vec3 Dice::direction() {
  std::normal_distribution<double> normal;
  const double x = normal(engine_), y = normal(engine_), z = normal(engine_);
  return Vec3(x, y, z).normalized();
}

Quat Dice::orientation() {
  std::normal_distribution<double> normal;
  const double w = normal(engine_), x = normal(engine_), y = normal(engine_), z = normal(engine_);
  return Quat(w, x, y, z).normalized();
}

SolidPtr gear_solid(int teeth, int flank_points, double phase_rad) {
  return generated("gear", {{"teeth", teeth},
                            {"flank_points", flank_points},
                            {"phase_rad", phase_rad},
                            {"width_mm", 10.0}});
}

SolidPtr bolt_solid(int facets) {
  return generated("bolt", {{"facets", facets}, {"turns", kBoltTurns}, {"shank_mm", kShank_mm}});
}

SolidPtr nut_solid(int facets) {
  return generated("nut", {{"facets", facets}, {"turns", kNutTurns}});
}

MotionSet sphere_set(int around, int down, int count) {
  MotionSet set;
  set.moving = set.fixed = solid(sphere_mesh(10.0, around, down));
  set.name = "spheres " + std::to_string((set.moving->mesh().triangles.size() + 500) / 1000) + "k";
  set.convex = true;
  set.truth = TruthSource::kFinest;
  Dice dice(101);
  fill(set, count, [&](int i) {
    const bool large = i % 3 == 2;
    const Vec3 u = dice.direction();
    const double apart_mm = dice.between(20.1, 32.0);
    const Pose X0{dice.orientation(), apart_mm * u};
    const Vec3 towards = (-u + dice.between(0.0, 0.7) * dice.direction()).normalized();
    const double way_mm =
        large ? dice.between(20.0, 60.0) : dice.between(1.0, 10.0) + apart_mm - 20.0;
    const double angle = kDegree * (large ? dice.between(90, 170) : dice.between(0.5, 5));
    return linear_motion(X0, turned(X0, angle * dice.direction(), way_mm * towards), Vec3::Zero());
  });
  return set;
}

MotionSet peg_set(double clearance_mm, int facets, int count) {
  MotionSet set;
  char name[48];
  std::snprintf(name, sizeof name, "peg, clearance %.2f, %d facets", clearance_mm, facets);
  set.name = name;
  set.moving = solid(prism_mesh(10.0 - 0.5 * clearance_mm, facets, -20, 20));
  set.fixed = solid(tube_mesh(10.0, 40.0, facets, -15, 15));
  set.truth = TruthSource::kFinest;
  Dice dice(102);
  fill(set, count, [&](int i) {
    const double z0 = dice.between(0.0, 30.0), around = dice.between(0.0, 2.0 * kPi);
    const Vec3 aside(std::cos(around), std::sin(around), 0.0);
    const Vec3 tilt = kDegree * dice.between(0.5, 5.0) * dice.direction();
    switch (i % 4) {
      case 0: {
        const Vec3 p = dice.between(0.0, 0.25) * clearance_mm * aside + Vec3(0, 0, z0);
        return slide(p, p - Vec3(0, 0, dice.between(1.0, 10.0)));
      }
      case 1: {
        const Pose X0 = shift(0, 0, z0);
        const Vec3 way = dice.between(0.5, 5.0) * aside - Vec3(0, 0, dice.between(1.0, 10.0));
        return linear_motion(X0, turned(X0, tilt, way), Vec3::Zero());
      }
      case 2: {
        const Pose X0 = shift(0, 0, z0);
        const Vec3 spin(0, 0, kDegree * dice.between(0.5, 5.0));
        return linear_motion(X0, turned(X0, spin, {0, 0, -dice.between(0.0, 3.0)}), Vec3::Zero());
      }
      default: {
        const Pose X0 =
            turn(kDegree * dice.between(0.0, 3.0) * dice.direction(),
                 {dice.between(-1.0, 1.0), dice.between(-1.0, 1.0), 35.0 + dice.between(0.5, 6.0)});
        const Vec3 way(dice.between(-1.0, 1.0), dice.between(-1.0, 1.0), -dice.between(3.0, 10.0));
        return linear_motion(X0, turned(X0, tilt, way), Vec3::Zero());
      }
    }
  });
  return set;
}

MotionSet wall_set(int count) {
  // A cube of 10 mm flies along x past a wall of 40 x 40 mm at the origin. The wall's lower edge is
  // at y = -20: the cube passes below by a gap, or overlaps the wall by as much and hits it.
  constexpr double kThick_mm = 0.001, kHalf = 5.0;
  MotionSet set;
  set.name = "box past a wall of 1 um";
  set.moving = solid(box_mesh({2 * kHalf, 2 * kHalf, 2 * kHalf}));
  set.fixed = solid(box_mesh({kThick_mm, 40, 40}));
  set.convex = true;
  set.truth = TruthSource::kClosedForm;
  Dice dice(103);
  fill(set, count, [&](int) {
    const double gap_mm = dice.sign() * dice.spread(1e-3, 5.0);
    const double start = -kHalf - dice.between(0.5, 20.0);
    const Vec3 from(start, -20.0 - kHalf - gap_mm, dice.between(-10.0, 10.0));
    return slide(from, from + Vec3(dice.between(10.0, 200.0), 0, dice.between(-5.0, 5.0)));
  });
  for (MotionSet::Item& item : set.items) {
    const Vec3 from = item.motion.X_W0.p;
    const double t = (-0.5 * kThick_mm - kHalf - from.x()) / item.motion.v_W.x();
    const bool in_the_way = from.y() + kHalf > -20.0;
    const bool beside = std::abs(from.z() + t * item.motion.v_W.z()) < 20.0 + kHalf;
    MORTISE_CHECK(beside, "the closed form holds for cubes that meet the face of the wall");
    item.contact = in_the_way && t < 1.0;
    if (item.contact) item.t_contact = t;
  }
  return set;
}

MotionSet helix_set(int count) {
  MotionSet set;
  set.name = "thread on thread (screw)";
  set.fixed = solid(ribbon(7.0, 8.0, 8, 96));
  set.moving = solid(ribbon(7.15, 8.15, 4, 96));
  set.truth = TruthSource::kFinest;
  Dice dice(104);
  fill(set, count, [&](int i) {
    const double angle =
        kDegree * dice.sign() * (i % 4 == 3 ? dice.between(90.0, 170.0) : dice.between(0.5, 5.0));
    const double error_mm = i % 3 == 2 ? dice.between(-0.5, 0.5) : 0.0;
    return on_thread(engaged(dice, 1.0, 3.0, 0.02), angle, {0, 0, error_mm});
  });
  return set;
}

MotionSet nut_set(int count) {
  MotionSet set;
  set.name = "nut on bolt";
  set.fixed = bolt_solid(96);
  set.moving = nut_solid(96);
  set.truth = TruthSource::kFinest;
  constexpr double kEnd_mm = kShank_mm + kPitch_mm * kBoltTurns;
  Dice dice(105);
  fill(set, count, [&](int i) {
    const double angle = kDegree * dice.sign() * dice.between(0.5, 5.0);
    if (i % 4 == 2) {
      const Pose X0 = turn(
          {0, 0, dice.between(-kPi, kPi)},
          {dice.between(-1.0, 1.0), dice.between(-1.0, 1.0), kEnd_mm + dice.spread(0.05, 5.0)});
      const Vec3 way(dice.between(-1.0, 1.0), dice.between(-1.0, 1.0), -dice.between(1.0, 10.0));
      return linear_motion(X0, turned(X0, angle * dice.direction(), way), Vec3::Zero());
    }
    Pose X0 = engaged(dice, 1.0, 4.0, 0.01);
    X0.p.z() += kShank_mm;
    const Vec3 error(i % 4 == 3 ? dice.between(-0.5, 0.5) : 0.0, 0.0,
                     i % 4 == 1 ? dice.between(-0.5, 0.5) : 0.0);
    return on_thread(X0, angle, error);
  });
  return set;
}

MotionSet nut_large_turn_set(int count) {
  MotionSet set = nut_set(0);
  set.name = "nut on bolt, 10-170 degrees";
  Dice dice(106);
  fill(set, count, [&](int i) {
    Pose X0 = engaged(dice, 1.0, 4.0, 0.01);
    X0.p.z() += kShank_mm;
    const double error_mm = i % 3 == 2 ? dice.between(-0.5, 0.5) : 0.0;
    return on_thread(X0, kDegree * dice.sign() * dice.between(10.0, 170.0), {0, 0, error_mm});
  });
  return set;
}

MotionSet gear_set(int count, int flank_points) {
  constexpr double kApart_mm = 60.0;  // module 2, 24 and 36 teeth
  MotionSet set;
  set.name = "gears";
  set.moving = gear_solid(24, flank_points, 0.0);
  TriangleMesh large = gear_solid(36, flank_points, kPi / 36.0)->mesh();
  for (Vec3& p : large.points_mm) p.x() += kApart_mm;
  set.fixed = solid(std::move(large));
  set.truth = TruthSource::kFinest;
  Dice dice(107);
  fill(set, count, [&](int i) {
    const double spin = kDegree * dice.sign() * dice.between(0.5, 5.0);
    switch (i % 4) {
      case 0:
        return move(shift(0, 0, dice.between(-5.0, 5.0)),
                    turn({0, 0, spin}, {0, 0, dice.between(-5.0, 5.0)}));
      case 1: {
        const double back_mm = dice.between(0.05, 4.0);
        return move(shift(-back_mm, 0, dice.between(-5.0, 5.0)),
                    turn({0, 0, 0.1 * spin}, {dice.between(0.0, 1.0), 0.0, 0.0}));
      }
      case 2: {
        const Pose X0 = shift(dice.between(-0.1, 0.0), 0, dice.between(-12.0, 12.0));
        return move(X0, turned(X0, {0, 0, 0.05 * spin}, {0, 0, dice.between(-10.0, 10.0)}));
      }
      default: {
        const Pose X0 = turn(0.1 * dice.direction(), {-dice.between(5.0, 15.0), 0, 0});
        const double angle = kDegree * dice.between(90.0, 170.0);
        const Vec3 way(dice.between(1.0, 15.0), dice.between(-5.0, 5.0), dice.between(-5.0, 5.0));
        return linear_motion(X0, turned(X0, angle * dice.direction(), way), Vec3::Zero());
      }
    }
  });
  return set;
}

MotionSet measured_set(const std::string& name, int count) {
  MotionSet set;
  testing::Workload workload;
  if (!load_workload(name, workload)) return set;
  set.name = "measured: " + name;
  set.moving = workload.moving;
  set.fixed = workload.fixed;
  set.convex = name.starts_with("sphere");
  set.truth = TruthSource::kMeasured;
  for (const auto& row : workload.rows) {
    MORTISE_CHECK(row.motion.reference_P.isZero(0.0), "peers turn parts about their origin");
    if (static_cast<int>(set.items.size()) < count)
      set.items.push_back({row.motion, row.contact, row.t_contact, row.max_speed_mm});
  }
  return set;
}

}  // namespace mortise::bench
