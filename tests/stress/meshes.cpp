#include "tests/stress/meshes.h"

#include <array>
#include <cmath>
#include <map>

#include "tests/support/numbers.h"

namespace mortise::stress {

using namespace mortise::testing;

double uniform(std::mt19937_64& random, double lo, double hi) {
  return std::uniform_real_distribution<double>(lo, hi)(random);
}

Vec3 random_vector(std::mt19937_64& random, double reach_mm) {
  const double x = uniform(random, -reach_mm, reach_mm), y = uniform(random, -reach_mm, reach_mm);
  return {x, y, uniform(random, -reach_mm, reach_mm)};
}

Vec3 random_turn(std::mt19937_64& random, double largest_rad) {
  Vec3 axis;
  do axis = random_vector(random, 1.0);
  while (axis.squaredNorm() > 1.0 || axis.squaredNorm() < 0.01);
  return axis.normalized() * uniform(random, 0.0, largest_rad);
}

TriangleMesh star_mesh(std::mt19937_64& random) {
  TriangleMesh mesh = sphere_mesh(1.0, 7, 4);
  for (Vec3& p : mesh.points_mm) p *= uniform(random, 0.35, 1.3);
  return mesh;
}

TriangleMesh torus_mesh(double radius, double thickness, int around, int across) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double u = 2 * kPi * i / around, v = 2 * kPi * j / across;
      const double r = radius + thickness * std::cos(v);
      mesh.points_mm.push_back({r * std::cos(u), r * std::sin(u), thickness * std::sin(v)});
    }
  const auto at = [&](int i, int j) {
    return static_cast<std::uint32_t>(i % around * across + j % across);
  };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

TriangleMesh soup_mesh(std::mt19937_64& random, int count) {
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3 c = random_vector(random, 0.5);
    Vec3 p[4];
    for (Vec3& x : p) x = c + random_vector(random, 0.7);
    append(mesh, tetrahedron_mesh(p[0], p[1], p[2], p[3]));
  }
  return mesh;
}

TriangleMesh boxes_mesh(std::mt19937_64& random, int count) {
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3 size(uniform(random, 0.1, 1.6), uniform(random, 0.1, 0.8),
                    uniform(random, 0.1, 0.5));
    const Vec3 w = random_turn(random, kPi);
    append(mesh, transformed(box_mesh(size), turn(w, random_vector(random, 0.4))));
  }
  return mesh;
}

TriangleMesh gear_mesh(double radius, int teeth, double thickness) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(4 * teeth);
  for (const double z : {-0.5 * thickness, 0.5 * thickness})
    for (std::uint32_t k = 0; k < n; ++k) {
      const double r = k % 4 < 2 ? radius : 0.8 * radius, angle = 2 * kPi * k / n;
      mesh.points_mm.push_back({r * std::cos(angle), r * std::sin(angle), z});
    }
  mesh.points_mm.push_back({0, 0, -0.5 * thickness});
  mesh.points_mm.push_back({0, 0, 0.5 * thickness});
  for (std::uint32_t j = 0; j < n; ++j) {
    const std::uint32_t k = (j + 1) % n;
    mesh.triangles.push_back({j, k, n + k});
    mesh.triangles.push_back({j, n + k, n + j});
    mesh.triangles.push_back({2 * n, k, j});
    mesh.triangles.push_back({2 * n + 1, n + j, n + k});
  }
  return mesh;
}

TriangleMesh refined(const TriangleMesh& mesh) {
  TriangleMesh fine;
  fine.points_mm = mesh.points_mm;
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t i, std::uint32_t j) {
    const auto [at, fresh] = middles.try_emplace({std::min(i, j), std::max(i, j)},
                                                 static_cast<std::uint32_t>(fine.points_mm.size()));
    if (fresh) fine.points_mm.push_back(0.5 * (mesh.points_mm[i] + mesh.points_mm[j]));
    return at->second;
  };
  for (const auto& t : mesh.triangles) {
    const std::uint32_t a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
    for (const std::array<std::uint32_t, 3>& part :
         {std::array{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}})
      fine.triangles.push_back(part);
  }
  return fine;
}

const char* shape_name(int kind) {
  constexpr const char* kNames[kShapes] = {"bar",  "convex", "star", "torus",
                                           "soup", "boxes",  "gear"};
  return kNames[kind];
}

SolidPtr random_shape(std::mt19937_64& random, int kind) {
  switch (kind) {
    case 0:
      return solid(box_mesh({1.5, 0.3, 0.4}));
    case 1:
      return solid(convex_mesh(random, 12));
    case 2:
      return solid(star_mesh(random));
    case 3:
      return solid(torus_mesh(0.9, uniform(random, 0.1, 0.4), 8, 5));
    case 4:
      return solid(soup_mesh(random, 8));
    case 5:
      return solid(boxes_mesh(random, 4));
    default:
      return solid(gear_mesh(1.0, 7, uniform(random, 0.1, 0.6)));
  }
}

}  // namespace mortise::stress
