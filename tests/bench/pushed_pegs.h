#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "common/session/tick/step.h"

namespace mortise::bench {

/// Diameter of pegs in bores of 20 mm, and the fit that is stated of them.
struct Fit {
  const char* name;
  double diameter_mm;
  const char* code;  ///< empty: nothing is declared
};

/// Pegs in their holes, each held by a designer of its own. Through step(), without a network.
class Pegs {
 public:
  Pegs(const Fit& fit, int count, const char* policy, int threads = 1);

  int count() const { return count_; }
  World& world() { return world_; }
  Vec3 position(int i) const { return world_.find(peg(i))->X_WP.p; }
  /// From the axis of its bore, mm.
  Vec3 off_axis(int i) const;

  /// One tick: peg i by by_mm[i], all by one turn.
  StepReport push(const std::vector<Vec3>& by_mm, const Vec3& turn_rad);

 private:
  PartId peg(int i) const { return PartId{static_cast<std::uint32_t>(count_ + i + 1)}; }

  World world_;
  Scratch scratch_;
  int count_;
  std::vector<UserId> users_;
  std::vector<std::uint64_t> sequence_;
  std::vector<Increment> increments_;
};

/// What came of pushes of many ticks. tick_ms: CPU time of this thread.
struct Pushed {
  double mm_a_tick = 0.0;        ///< and peg
  double least_mm_a_tick = 0.0;  ///< of the peg that moved least
  std::uint64_t not_examined = 0;
  std::vector<double> tick_ms;
  double wall_s = 0.0;  ///< of all ticks
};
/// Down and up in the hole, while hands tremble and turn.
Pushed push_all(const Fit& fit, int count, const char* policy, int ticks, int threads = 1);

/// Against the wall in one tick, away from it in the next one, policy stop.
struct Shaken {
  long long away = 0;         ///< pushes away from the wall
  long long carried_out = 0;  ///< those that moved as far as asked
  std::uint64_t not_examined = 0;
  std::vector<double> tick_ms;
};
Shaken shake_all(const Fit& fit, int count, int ticks);

}  // namespace mortise::bench
