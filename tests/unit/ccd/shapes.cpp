#include "tests/unit/ccd/shapes.h"

#include <cmath>

#include "tests/support/numbers.h"

namespace mortise::testing {

TriangleMesh box_mesh(const Vec3& size, const Vec3& center) {
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.points_mm.push_back(center + Vec3((k & 1 ? 0.5 : -0.5) * size.x(),
                                           (k & 2 ? 0.5 : -0.5) * size.y(),
                                           (k & 4 ? 0.5 : -0.5) * size.z()));
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TriangleMesh sphere_mesh(double radius, int around, int down) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(around);
  mesh.points_mm.push_back({0, 0, radius});
  for (int i = 1; i < down; ++i)
    for (int j = 0; j < around; ++j) {
      const double theta = kPi * i / down, phi = 2 * kPi * j / around;
      mesh.points_mm.push_back(radius * Vec3(std::sin(theta) * std::cos(phi),
                                             std::sin(theta) * std::sin(phi), std::cos(theta)));
    }
  mesh.points_mm.push_back({0, 0, -radius});
  const auto last = static_cast<std::uint32_t>(mesh.points_mm.size() - 1);
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return 1 + (i - 1) * n + j % n; };
  const auto rows = static_cast<std::uint32_t>(down);
  for (std::uint32_t j = 0; j < n; ++j) {
    mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
    mesh.triangles.push_back({last, at(rows - 1, j + 1), at(rows - 1, j)});
    for (std::uint32_t i = 1; i + 1 < rows; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

TriangleMesh prism_mesh(double radius, int n, double z0, double z1) {
  TriangleMesh mesh;
  const auto count = static_cast<std::uint32_t>(n);
  for (double z : {z0, z1})
    for (int j = 0; j < n; ++j)
      mesh.points_mm.push_back(
          {radius * std::cos(2 * kPi * j / n), radius * std::sin(2 * kPi * j / n), z});
  mesh.points_mm.push_back({0, 0, z0});
  mesh.points_mm.push_back({0, 0, z1});
  for (std::uint32_t j = 0; j < count; ++j) {
    const std::uint32_t k = (j + 1) % count;
    mesh.triangles.push_back({j, k, count + k});
    mesh.triangles.push_back({j, count + k, count + j});
    mesh.triangles.push_back({2 * count, k, j});
    mesh.triangles.push_back({2 * count + 1, count + j, count + k});
  }
  return mesh;
}

TriangleMesh tube_mesh(double inner, double outer, int n, double z0, double z1) {
  TriangleMesh mesh;
  const auto count = static_cast<std::uint32_t>(n);
  for (double radius : {inner, outer})
    for (double z : {z0, z1})
      for (int j = 0; j < n; ++j)
        mesh.points_mm.push_back(
            {radius * std::cos(2 * kPi * j / n), radius * std::sin(2 * kPi * j / n), z});
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (std::uint32_t j = 0; j < count; ++j) {
    const std::uint32_t k = (j + 1) % count;
    const std::uint32_t i0 = 0, i1 = count, o0 = 2 * count, o1 = 3 * count;
    quad(i0 + k, i0 + j, i1 + j, i1 + k);
    quad(o0 + j, o0 + k, o1 + k, o1 + j);
    quad(i0 + j, i0 + k, o0 + k, o0 + j);
    quad(i1 + k, i1 + j, o1 + j, o1 + k);
  }
  return mesh;
}

TriangleMesh tetrahedron_mesh(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  TriangleMesh mesh;
  mesh.points_mm = {a, b, c, d};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  return signed_volume_mm3(mesh) > 0.0 ? mesh : inside_out(mesh);
}

TriangleMesh convex_mesh(std::mt19937_64& random, int n) {
  std::normal_distribution<double> normal;
  const Vec3 radii(0.6 + 0.4 * std::abs(normal(random)), 0.6 + 0.4 * std::abs(normal(random)),
                   0.6 + 0.4 * std::abs(normal(random)));
  TriangleMesh mesh;
  for (int i = 0; i < n; ++i) {
    const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
    mesh.points_mm.push_back(direction.cwiseProduct(radii));
  }
  // The hull of few points in general position: every triple with all others on one side.
  const auto count = static_cast<std::uint32_t>(n);
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::uint32_t j = i + 1; j < count; ++j)
      for (std::uint32_t k = j + 1; k < count; ++k) {
        const Vec3 normal_ijk =
            (mesh.points_mm[j] - mesh.points_mm[i]).cross(mesh.points_mm[k] - mesh.points_mm[i]);
        int above = 0, below = 0;
        for (std::uint32_t m = 0; m < count; ++m) {
          if (m == i || m == j || m == k) continue;
          (normal_ijk.dot(mesh.points_mm[m] - mesh.points_mm[i]) > 0.0 ? above : below)++;
        }
        if (above == 0) mesh.triangles.push_back({i, j, k});
        if (below == 0) mesh.triangles.push_back({i, k, j});
      }
  return mesh;
}

void append(TriangleMesh& to, const TriangleMesh& from) {
  const auto offset = static_cast<std::uint32_t>(to.points_mm.size());
  to.points_mm.insert(to.points_mm.end(), from.points_mm.begin(), from.points_mm.end());
  for (auto triangle : from.triangles) {
    for (auto& index : triangle) index += offset;
    to.triangles.push_back(triangle);
  }
}

TriangleMesh inside_out(TriangleMesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

TriangleMesh scaled(TriangleMesh mesh, double factor) {
  for (Vec3& point : mesh.points_mm) point *= factor;
  return mesh;
}

SolidPtr solid(TriangleMesh mesh) { return std::make_shared<Solid>(std::move(mesh)); }

Pose shift(double x, double y, double z) { return Pose::translation({x, y, z}); }

Pose turn(const Vec3& rotation_rad, const Vec3& p_mm) { return {rotation_exp(rotation_rad), p_mm}; }

Pose random_pose(std::mt19937_64& random, double reach_mm, double largest_angle_rad) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Vec3 axis = Vec3(unit(random), unit(random), unit(random)).normalized();
  const double angle = largest_angle_rad * unit(random);
  return turn(axis * angle, reach_mm * Vec3(unit(random), unit(random), unit(random)));
}

Motion move(const Pose& X0, const Pose& X1) { return linear_motion(X0, X1, Vec3::Zero()); }

Motion slide(const Vec3& from, const Vec3& to) {
  return move(Pose::translation(from), Pose::translation(to));
}

ContactQuery query(const SolidPtr& a, const Motion& motion_a, const SolidPtr& b,
                   const Motion& motion_b) {
  ContactQuery q;
  q.a = a.get();
  q.b = b.get();
  q.motion_a = motion_a;
  q.motion_b = motion_b;
  return q;
}

FirstContact solve(const ContactQuery& query) {
  CcdScratch scratch;
  return first_contact(query, scratch);
}

FirstContact solve(const SolidPtr& a, const Motion& motion_a, const SolidPtr& b,
                   const Motion& motion_b) {
  return solve(query(a, motion_a, b, motion_b));
}

}  // namespace mortise::testing
