#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tests/bench/scenes.h"

namespace mortise::bench {

enum class Outcome { kNotAsked = 0, kContact, kFree, kUndecided, kOverTime, kCrashed };

struct Answer {
  Outcome outcome = Outcome::kNotAsked;
  double t = 1.0;       ///< of contact
  double time_s = 0.0;  ///< CPU, least of a few
  bool decided() const { return outcome == Outcome::kContact || outcome == Outcome::kFree; }
};

/// One way to find first contacts, prepared for one set of motions.
struct Method {
  std::string name;
  bool ours = false;
  bool portable = false;  ///< ours without vector code: never the one that peers are held against
  double accuracy_mm = 0.0;  ///< what it is asked for; 0: it promises nothing in mm
  std::function<Answer(const Motion&)> ask;
};

/// CPU time that a method may take: for one motion, and for all motions of a set. A method over the
/// first limit, or one that crashes, loses its process and goes on with the next motion.
struct Limits {
  double query_s = 2.0, set_s = 2.0;
};

/// Each motion in turn in a child process; those that the time did not suffice for: kNotAsked.
std::vector<Answer> ask_guarded(const Method& method, const MotionSet& set, const Limits& limits);
/// In this process: for methods that are known to end.
std::vector<Answer> ask_all(const Method& method, const MotionSet& set);

Method ours(const MotionSet& set, double accuracy_mm);
/// Ours without vector instructions.
Method ours_portable(const MotionSet& set, double accuracy_mm);

/// FCL: its continuous collision as shipped, the same repaired, advancement on its distance, and
/// its collision test at sub-steps.
std::vector<Method> fcl_methods(const MotionSet& set);
constexpr const char* kShipped = "FCL advancement as shipped, OBBRSS";
constexpr const char* kRepairedOBBRSS = "FCL advancement repaired, OBBRSS";
constexpr const char* kRepairedRSS = "FCL advancement repaired, RSS";
constexpr const char* kOnDistance = "advancement on FCL distance";
constexpr const char* kSubSteps10 = "FCL collide, 10 sub-steps";
constexpr const char* kSubSteps100 = "FCL collide, 100 sub-steps";
constexpr const char* kSubSteps1000 = "FCL collide, 1000 sub-steps";

/// Bullet's continuous convex cast of the hulls; only for sets of convex parts.
Method bullet_method(const MotionSet& set);
constexpr const char* kBullet = "Bullet continuous convex";

}  // namespace mortise::bench
