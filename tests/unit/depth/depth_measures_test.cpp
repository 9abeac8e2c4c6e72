// The overlap, the generalized depth and the volume of the least and of the largest bodies give one
// class (common/depth/README.md, section 7).
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "common/depth/gpd/hull_depth.h"
#include "tests/support/effort.h"
#include "tests/unit/depth/random_polyhedra.h"

namespace mortise {
namespace {

using polyhedra::Body;
using polyhedra::Polyhedron;

std::vector<polyhedra::HalfSpace> body_of(const Polyhedron& part, const Pose& X, Body body) {
  std::vector<polyhedra::HalfSpace> all;
  for (const polyhedra::HalfSpace& h : part.half_spaces) {
    const Eigen::Vector4d row = polyhedra::row_of(h, X, body);
    all.push_back({row.head<3>(), row[3], {}});
  }
  return all;
}

// What a face no longer reaches falls away.
SolidPtr solid_of(std::vector<polyhedra::HalfSpace> half_spaces) {
  for (std::size_t i = 0; i < half_spaces.size();) {
    int corners = 0;
    for (const Vec3& x : polyhedra::corners_of(half_spaces))
      corners += std::fabs(half_spaces[i].n.dot(x) - half_spaces[i].c) < 1e-9;
    if (corners >= 3)
      ++i;
    else
      half_spaces.erase(half_spaces.begin() + static_cast<std::ptrdiff_t>(i));
  }
  TriangleMesh mesh;
  std::vector<std::uint16_t> face_of;
  if (!polyhedra::mesh_of(half_spaces, mesh, face_of)) return nullptr;
  auto solid = std::make_shared<const Solid>(std::move(mesh));
  return solid->topology().closed() ? solid : nullptr;
}

// Do the two bodies have a common volume? By the corners of their intersection.
bool share_volume(std::vector<polyhedra::HalfSpace> a, const std::vector<polyhedra::HalfSpace>& b) {
  a.insert(a.end(), b.begin(), b.end());
  const std::vector<Vec3> corners = polyhedra::corners_of(a);
  if (corners.size() < 4) return false;
  Mat3 spread = Mat3::Zero();
  for (const Vec3& x : corners) spread += (x - corners[0]) * (x - corners[0]).transpose();
  return spread.determinant() > 0.0;
}

// Where the hulls of the parts as modelled just touch along a line.
double contact_mm(const Polyhedron& a, const Polyhedron& b, const Quat& q, const Vec3& along) {
  double in = 0.0, out = 30.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (in + out);
    const Pose X{q, middle * along};
    (gpd::hull_depth(*a.solid, X, *b.solid, Pose(), 1e-6).depth_mm.lo > 0.0 ? in : out) = middle;
  }
  return in;
}

struct Measures {
  double delta_mm = 0.0;
  Interval gpd_mm;
  bool volume = false;
};

std::optional<Measures> measure(const Polyhedron& a, const Polyhedron& b, const Pose& X_BA,
                                Body body) {
  const auto in_a = body_of(a, X_BA, body), in_b = body_of(b, Pose(), body);
  const SolidPtr solid_a = solid_of(in_a), solid_b = solid_of(in_b);
  if (!solid_a || !solid_b) return std::nullopt;
  return Measures{true_margin(a, b, X_BA, body),
                  gpd::hull_depth(*solid_a, Pose(), *solid_b, Pose(), 1e-9).depth_mm,
                  share_volume(in_a, in_b)};
}

TEST(DepthMeasures, GiveOneClassAskedOfTheLeastAndTheLargestBodies) {
  polyhedra::Random random(2027);
  int asked[3] = {0, 0, 0};
  const int pairs = test::effort(150);
  for (int i = 0; i < pairs; ++i) {
    const Polyhedron a = polyhedra::random_convex(random), b = polyhedra::random_convex(random);
    Pose X_BA{polyhedra::rotation(random), Vec3::Zero()};
    // Near contact of the parts as modelled.
    const Vec3 along = polyhedra::direction(random);
    X_BA.p = contact_mm(a, b, X_BA.q, along) * along;
    X_BA.p += polyhedra::between(random, -0.15, 0.15) * along;
    const auto least = measure(a, b, X_BA, Body::kLeast),
               largest = measure(a, b, X_BA, Body::kLargest);
    if (!least || !largest) continue;
    constexpr double kTouch_mm = 1e-6;
    if (std::fabs(least->delta_mm) < kTouch_mm || std::fabs(largest->delta_mm) < kTouch_mm)
      continue;
    const int by_delta = least->delta_mm > 0.0 ? 2 : largest->delta_mm > 0.0 ? 1 : 0;
    const int by_gpd = least->gpd_mm.lo > 0.0 ? 2 : largest->gpd_mm.lo > 0.0 ? 1 : 0;
    const int by_volume = least->volume ? 2 : largest->volume ? 1 : 0;
    EXPECT_EQ(by_delta, by_gpd) << i;
    EXPECT_EQ(by_delta, by_volume) << i;
    EXPECT_LE(least->gpd_mm.lo, largest->gpd_mm.hi + 1e-9) << i;
    ++asked[by_delta];
  }
  for (const int count : asked) EXPECT_GT(count, pairs / 20);
}

}  // namespace
}  // namespace mortise
