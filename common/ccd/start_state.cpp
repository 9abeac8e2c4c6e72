#include "common/ccd/start_state.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/check.h"
#include "common/ccd/pair_tree.h"
#include "common/geometry/signed_distance.h"

namespace mortise::ccd {
namespace {

// A stop leaves triangles at most one accuracy deep (see Goal); twice that is still "touching".
constexpr double kTouchingDepth = 2.0;

// How far behind the skin of one part it is asked whether the other's inside is there, too; deeper
// than any touching, far below any wall.
constexpr double kBehindSkin = 8.0;

// Triangles in contact of either part behind which one looks: meshes that share a skin do so almost
// everywhere.
constexpr int kSkinProbes = 16;

// Beyond the limit nothing is found.
bool near_skin(const Solid& solid, const Vec3& x, double margin_mm) {
  return nearest_point(solid, x, margin_mm).triangle != Topology::kNone;
}

bool inside_deeper(const Solid& solid, const Vec3& x, double margin_mm) {
  const Box& box = solid.bounds();
  if ((x.array() < box.lo.array()).any() || (x.array() > box.hi.array()).any()) return false;
  return inside(solid, x) && !near_skin(solid, x, margin_mm);
}

// Does a shell of `inner` start inside `outer`? Of each shell some corner is asked that does not
// lie in the skin of the other.
Containment shell_inside(const Solid& inner, const Solid& outer, const Pose& X_OuterInner,
                         double margin_mm) {
  const Box& box = outer.bounds();
  Containment answer = Containment::kNo;
  for (const std::uint32_t triangle : inner.shells()) {
    bool covered = false, asked = false;
    for (int k = 0; k < 4 && !asked; ++k) {
      const TriangleMesh& mesh = inner.mesh();
      const Vec3 x = k < 3 ? mesh.corner(triangle, k)
                           : Vec3((mesh.corner(triangle, 0) + mesh.corner(triangle, 1) +
                                   mesh.corner(triangle, 2)) /
                                  3.0);
      const Vec3 y = X_OuterInner * x;
      asked = (y.array() < box.lo.array()).any() || (y.array() > box.hi.array()).any();
      if (asked || near_skin(outer, y, margin_mm)) continue;
      if (!outer.has_inside()) return Containment::kUnknown;
      if (outer.cracks().cover(y)) {
        covered = true;
        continue;
      }
      if (inside(outer, y)) return Containment::kYes;
      asked = true;
    }
    if (covered && !asked) answer = Containment::kUnknown;
  }
  return answer;
}

// The last distinct triangles seen, few.
class Probes {
 public:
  bool first_time(std::uint32_t triangle) {
    for (int i = 0; i < count_; ++i)
      if (seen_[i] == triangle) return false;
    if (count_ == kSkinProbes) return false;
    seen_[count_++] = triangle;
    return true;
  }

 private:
  std::array<std::uint32_t, kSkinProbes> seen_{};
  int count_ = 0;
};

}  // namespace

StartState start_state(PairMotion& motion, const Solid& a, const Solid& b, const StartQuery& query,
                       CcdScratch& scratch, CcdWork& work) {
  StartState state;
  const PairState& pose = motion.state();
  const bool closed = a.has_inside() && b.has_inside();
  Probes probes_a, probes_b;
  const double behind_mm = kBehindSkin * query.accuracy_mm;
  const auto behind = [&](const Triangle& t) {
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
    const double length = n.norm();
    const Vec3 middle = (t[0] + t[1] + t[2]) / 3.0;
    return length > 0.0 ? Vec3(middle - n * (behind_mm / length)) : middle;
  };
  const auto skin_shared = [&](const Nearest& pair, const Triangle& x, const Triangle& y) {
    if (probes_a.first_time(pair.triangle_a) &&
        inside_deeper(b, behind(x) + b.bvh().origin, 0.5 * behind_mm))
      return true;
    return probes_b.first_time(pair.triangle_b) &&
           inside_deeper(a, pose.R.transpose() * (behind(y) - pose.p) + a.bvh().origin,
                         0.5 * behind_mm);
  };
  each_leaf_pair_within(
      motion, a.bvh(), b.bvh(), query.contact_mm, scratch, work, [&](LeafPair& leaves) {
        ++work.leaf_tests;
        return leaves.each_within(
            motion, query.contact_mm, work,
            [&](const Nearest& pair, const Triangle& x, const Triangle& y) {
              Nearest found = pair;
              state.near = true;
              if (pair.distance_mm <= query.accuracy_mm) {
                const TriangleSeparation separation = triangle_separation(x, y);
                if (separation.distance_mm < 0.0) found.distance_mm = separation.distance_mm;
                if (separation.distance_mm <= query.deep_mm &&
                    leaves.closing_speed(motion, separation.normal, x, y) >
                        0.125 * query.accuracy_mm)
                  state.pressing = true;
                state.overlapping = separation.distance_mm < -kTouchingDepth * query.accuracy_mm;
                if (!state.overlapping && closed && skin_shared(pair, x, y))
                  state.overlapping = state.skin_shared = true;
              }
              if (found.distance_mm < state.nearest.distance_mm || state.overlapping)
                state.nearest = found;
              return state.overlapping;
            });
      });
  return state;
}

}  // namespace mortise::ccd

namespace mortise {

Containment containment(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                        double margin_mm) {
  MORTISE_CHECK(valid(X_WA) && valid(X_WB), "poses must be finite and their quaternions unit");
  MORTISE_CHECK(margin_mm >= 0.0 && std::isfinite(margin_mm), "a margin must be a length");
  const Pose X_BA{(X_WB.q.conjugate() * X_WA.q).normalized(),
                  X_WB.q.conjugate() * (X_WA.p - X_WB.p)};
  const Containment first = ccd::shell_inside(a, b, X_BA, margin_mm);
  if (first == Containment::kYes) return first;
  return std::max(first, ccd::shell_inside(b, a, X_BA.inverse(), margin_mm));
}

bool contained(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
               double margin_mm) {
  return containment(a, X_WA, b, X_WB, margin_mm) == Containment::kYes;
}

}  // namespace mortise
