#include "tests/bench/gpd_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "common/ccd/first_contact.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random) { return std::uniform_real_distribution<double>()(random); }
Vec3 normal_vector(Random& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random));
}
Quat any_turn(Random& random) {
  std::normal_distribution<double> normal;
  return Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
}

// By every triple of points: all others lie on one side of it.
TriangleMesh random_hull(Random& random) {
  std::normal_distribution<double> normal;
  TriangleMesh mesh;
  const Vec3 size(std::exp(0.7 * normal(random)), std::exp(0.7 * normal(random)),
                  std::exp(0.7 * normal(random)));
  const auto n = static_cast<std::uint32_t>(8 + 14.0 * uniform(random));
  for (std::uint32_t i = 0; i < n; ++i)
    mesh.points_mm.push_back(10.0 * size.cwiseProduct(normal_vector(random).normalized()));
  const auto& p = mesh.points_mm;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = i + 1; j < n; ++j)
      for (std::uint32_t k = j + 1; k < n; ++k) {
        const Vec3 across = (p[j] - p[i]).cross(p[k] - p[i]);
        bool above = false, below = false;
        for (std::uint32_t l = 0; l < n; ++l)
          if (l != i && l != j && l != k) (across.dot(p[l] - p[i]) > 0.0 ? above : below) = true;
        if (above && !below) mesh.triangles.push_back({i, k, j});
        if (below && !above) mesh.triangles.push_back({i, j, k});
      }
  return mesh;
}

TriangleMesh hook(double s) {
  return shapes::prism(
      {{0, 0}, {30 * s, 0}, {30 * s, 20 * s}, {20 * s, 20 * s}, {20 * s, 8 * s}, {0, 8 * s}},
      {{0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}}, 0.0, 12.0);
}

TriangleMesh random_shape(Random& random, bool hollow) {
  const double s = std::exp(0.4 * (uniform(random) - 0.5));
  switch (static_cast<int>((hollow ? 3.0 : 6.0) * uniform(random))) {
    case 0:
      return hook(s);
    case 1:
      return shapes::u_slot(10.0 * s, 4.0 * s, 8.0 * s, 5.0, 0.0, 20.0);
    case 2:
      return shapes::ring(
          {8.0 * s, 0.0, 10.0, 12 + 4 * static_cast<int>(4.0 * uniform(random)), 1, 0.3}, 16.0 * s);
    case 3:
      return shapes::peg({6.0 * s, 0.0, 25.0, 16, 1, 0.1});
    case 4:
      return shapes::box(Vec3(4.0 * s, 3.0, 10.0));
    default:
      return shapes::together(shapes::peg({3.0 * s, 0.0, 20.0, 12, 1, 0.0}),
                              shapes::box(Vec3(9.0, 9.0, 2.0), Vec3(0, 0, -2.0)));
  }
}

// A comes along a line until it touches, and some of its size farther. False: it never does.
bool place(Random& random, GpdPair& pair) {
  const Vec3 d = normal_vector(random).normalized();
  const double ra = pair.a->sphere().radius_mm, rb = pair.b->sphere().radius_mm;
  pair.X_WB = {any_turn(random), 10.0 * normal_vector(random)};
  Pose near{any_turn(random), Vec3::Zero()};
  near.p = pair.X_WB * pair.b->sphere().center_mm - near.q * pair.a->sphere().center_mm;
  Pose far = near;
  far.p += 1.2 * (ra + rb) * d;
  ContactQuery query;
  query.a = pair.a.get();
  query.b = pair.b.get();
  query.motion_a = linear_motion(far, near, pair.a->sphere().center_mm);
  query.motion_b = still_motion(pair.X_WB);
  CcdScratch scratch;
  const FirstContact contact = first_contact(query, scratch);
  if (contact.state != ContactState::kContact) return false;
  pair.X_WA = query.motion_a.pose_at(contact.t_contact);
  pair.X_WA.p -= 0.5 * ra * std::pow(10.0, -3.0 * uniform(random)) * d;
  return true;
}

struct Sides {
  std::vector<Vec3> points, normals, edges;
  Sides(const Solid& part, const Pose& X) {
    for (const Vec3& x : part.mesh().points_mm) points.push_back(X * x);
    for (const auto& t : part.mesh().triangles) {
      normals.push_back((points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]));
      for (std::size_t k = 0; k < 3; ++k)
        if (t[k] < t[(k + 1) % 3]) edges.push_back(points[t[(k + 1) % 3]] - points[t[k]]);
    }
  }
  Interval along(const Vec3& n) const {
    Interval all{1e300, -1e300};
    for (const Vec3& x : points) all = hull(all, {n.dot(x), n.dot(x)});
    return all;
  }
};

}  // namespace

GpdPair draw_convex_pair(std::uint64_t seed) {
  Random random(seed);
  for (;;) {
    GpdPair pair{shapes::solid(random_hull(random)), shapes::solid(random_hull(random)), {}, {}};
    if (place(random, pair)) return pair;
  }
}

GpdPair draw_hollow_pair(std::uint64_t seed) {
  Random random(seed + 77'000'000);
  for (;;) {
    const bool a_is_hollow = uniform(random) < 0.5;
    GpdPair pair{shapes::solid(random_shape(random, a_is_hollow)),
                 shapes::solid(random_shape(random, !a_is_hollow)),
                 {},
                 {}};
    if (place(random, pair)) return pair;
  }
}

double minkowski_depth_mm(const GpdPair& pair) {
  const Sides a(*pair.a, pair.X_WA), b(*pair.b, pair.X_WB);
  double least = std::numeric_limits<double>::infinity();
  const auto ask = [&](const Vec3& across) {
    const double size = across.norm();
    if (!(size > 1e-9)) return;
    const Interval on_a = a.along(across / size), on_b = b.along(across / size);
    least = std::min({least, on_b.hi - on_a.lo, on_a.hi - on_b.lo});
  };
  for (const Vec3& n : a.normals) ask(n);
  for (const Vec3& n : b.normals) ask(n);
  for (const Vec3& e : a.edges)
    for (const Vec3& f : b.edges) ask(e.cross(f));
  return least;
}

}  // namespace mortise::bench
