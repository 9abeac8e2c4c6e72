#include "tests/stress/random_cases.h"

#include <numbers>

namespace mortise::stress {

double uniform(std::mt19937_64& random, double lo, double hi) {
  return std::uniform_real_distribution<double>(lo, hi)(random);
}

Case random_case(std::uint64_t seed) {
  constexpr double kPi = std::numbers::pi;
  std::mt19937_64 random(seed);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  Case c;
  c.a = random_shape(random, below(kShapes));
  c.b = random_shape(random, below(kShapes));
  const double largest[] = {0.0, 0.1, 1.0, kPi};
  const auto motion = [&](const Vec3& from, const Vec3& to) {
    const Pose start{rotation_exp(random_turn(random, kPi)), from};
    const Vec3 w = random_turn(random, largest[below(4)]);
    const Pose end{w.isZero(0.0) ? start.q : (rotation_exp(w) * start.q).normalized(), to};
    const Vec3 reference = random_vector(random, 0.5);
    return below(3) == 0 ? screw_motion(start, end, reference)
                         : linear_motion(start, end, reference);
  };
  const Vec3 direction = random_turn(random, 1.0).normalized();
  const Vec3 side = 2.6 * direction + random_vector(random, 0.8);
  const double reach = below(2) == 0 ? 1.0 : -0.3;
  const Vec3 from = side + random_vector(random, 0.5);
  c.motion_a = motion(from, -reach * side + random_vector(random, 1.0));
  const Vec3 at = random_vector(random, 0.5);
  if (below(2) == 0)
    c.motion_b = still_motion({rotation_exp(random_turn(random, kPi)), at});
  else
    c.motion_b = motion(at, at + random_vector(random, 1.0));
  const double accuracies[] = {1e-2, 1e-4, 1e-6, 1e-6, 1e-9};
  c.accuracy_mm = accuracies[below(5)];
  if (below(4) == 0) c.separation_mm = uniform(random, 0.0, 0.3);
  c.check_contained = true;
  return c;
}

}  // namespace mortise::stress
