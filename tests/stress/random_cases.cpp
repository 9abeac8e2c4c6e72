#include "tests/stress/random_cases.h"

#include "tests/support/numbers.h"

namespace mortise::stress {

Motion same_path(const Motion& like, const Pose& X_W0, const Pose& X_W1, const Vec3& reference_P) {
  if (like.kind == PathKind::kStill) return still_motion(X_W0);
  return like.kind == PathKind::kScrew ? screw_motion(X_W0, X_W1, reference_P)
                                       : linear_motion(X_W0, X_W1, reference_P);
}

Case scaled(const Case& c, double factor) {
  Case s = c;
  const auto part = [&](const SolidPtr& solid) {
    return testing::solid(testing::scaled(solid->mesh(), factor));
  };
  const auto path = [&](const Motion& m) {
    return same_path(m, {m.X_W0.q, factor * m.X_W0.p}, {m.X_W1.q, factor * m.X_W1.p},
                     factor * m.reference_P);
  };
  s.a = part(c.a);
  s.b = part(c.b);
  s.motion_a = path(c.motion_a);
  s.motion_b = path(c.motion_b);
  s.accuracy_mm *= factor;
  s.separation_mm *= factor;
  return s;
}

Case moved(const Case& c, const Pose& G) {
  Case s = c;
  const auto path = [&](const Motion& m) {
    // Bit for bit the same turn stays none.
    const Quat q0 = (G.q * m.X_W0.q).normalized();
    const bool turns = !(m.X_W0.q.coeffs().array() == m.X_W1.q.coeffs().array()).all();
    const Quat q1 = turns ? (G.q * m.X_W1.q).normalized() : q0;
    return same_path(m, {q0, G * m.X_W0.p}, {q1, G * m.X_W1.p}, m.reference_P);
  };
  s.motion_a = path(c.motion_a);
  s.motion_b = path(c.motion_b);
  return s;
}

Case with_far_mesh(const Case& c, const Vec3& away_mm) {
  Case s = c;
  TriangleMesh mesh = c.a->mesh();
  for (Vec3& p : mesh.points_mm) p += away_mm;
  s.a = testing::solid(mesh);
  const Motion& m = c.motion_a;
  const auto back = [&](const Pose& X) { return Pose{X.q, X.p - X.q * away_mm}; };
  s.motion_a = same_path(m, back(m.X_W0), back(m.X_W1), m.reference_P + away_mm);
  return s;
}

Case random_case(std::uint64_t seed) {
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
