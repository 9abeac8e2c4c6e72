#pragma once
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "common/geometry/solid.h"
#include "common/motion/motion.h"

namespace mortise::bench {

/// Where the true time of contact of a set is known from.
enum class TruthSource {
  kUnknown = 0,
  kClosedForm,  ///< exact to rounding
  kMeasured,    ///< the data set's own slow method, to 1e-7 mm of distance
  kFinest,      ///< our own answer at 1e-10 mm; held against advancement on FCL's distance
};

/// One moving part, one static part at identity, and motions of the moving one. The reference point
/// of every motion is the moving part's origin. No motion starts in contact.
struct MotionSet {
  struct Item {
    Motion motion;
    bool contact = false;
    double t_contact = 1.0;
    double speed_mm = 0.0;  ///< no point of the part travels faster, mm per tick
  };
  std::string name;
  SolidPtr moving, fixed;
  bool convex = false;  ///< both parts are convex
  TruthSource truth = TruthSource::kUnknown;
  std::vector<Item> items;
};

/// Random numbers of one scene: a literal seed, the same motions on every run.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double between(double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(engine_);
  }
  /// Evenly spread over the decades from a to b, both > 0.
  double spread(double a, double b);
  double sign() { return between(-1.0, 1.0) < 0.0 ? -1.0 : 1.0; }
  Vec3 direction();
  Quat orientation();

 private:
  std::mt19937_64 engine_;
};

MotionSet sphere_set(int around, int down, int count);
/// Peg of radius 10 - clearance / 2 and bore of radius 10, both with `facets` sides in phase:
/// slides, pushes aside, turns about its axis, and comes from above, in turns.
MotionSet peg_set(double clearance_mm, int facets, int count);
/// Boxes that pass, or hit, a wall of 1 um on the way; truth in closed form.
MotionSet wall_set(int count);
/// Ribbon with a triangular profile inside another one, on screws of the common pitch.
MotionSet helix_set(int count);
/// A nut on and above its M16 bolt: ticks of up to 5 degrees.
MotionSet nut_set(int count);
/// The nut on the bolt turned by 10 to 170 degrees at once.
MotionSet nut_large_turn_set(int count);
/// Two spur gears in mesh and apart.
MotionSet gear_set(int count, int flank_points = 24);
/// A fit of the data sets (its id there): the part inserted and moved as peg_set does, a nut turned
/// along its bolt; empty when the data are not there.
MotionSet fit_set(const std::string& id, int count);
const std::vector<std::string>& fit_ids();
/// One of the sets of measured motions; empty when the data are not there.
MotionSet measured_set(const std::string& name, int count);

/// make(i) until there are `count` motions that start apart.
void fill(MotionSet& set, int count, const std::function<Motion(int)>& make);
/// X turned about its own origin, world axes, and shifted.
Pose turned(const Pose& X, const Vec3& rotation_rad, const Vec3& shift_mm);

/// Solids of the tables "distance", "build" and "triangles" as well.
SolidPtr gear_solid(int teeth, int flank_points, double phase_rad);
SolidPtr bolt_solid(int facets);
SolidPtr nut_solid(int facets);

}  // namespace mortise::bench
