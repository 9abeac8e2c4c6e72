#pragma once
#include <array>
#include <memory>
#include <string>

#include "common/session/world/world.h"

namespace mortise::testing {

/// A closed cube of edge 2 * half_mm about the origin.
inline TriangleMesh cube(double half_mm) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.points_mm.emplace_back((i & 1) ? half_mm : -half_mm, (i & 2) ? half_mm : -half_mm,
                                (i & 4) ? half_mm : -half_mm);
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// Part 1 "wall" is static at the origin; parts 2 "red" and 3 "blue" move, at x = 20 and x = -20.
/// All are cubes of edge 10 mm.
inline World small_world() {
  World world;
  world.name = "small";
  world.lease_s = 2.0;
  const auto solid = std::make_shared<const Solid>(cube(5.0));
  const std::array<std::pair<const char*, double>, 3> parts = {
      {{"wall", 0.0}, {"red", 20.0}, {"blue", -20.0}}};
  for (const auto& [name, x_mm] : parts) {
    Part part;
    part.id = PartId{static_cast<std::uint32_t>(world.parts.size()) + 1};
    part.name = name;
    part.solid = solid;
    part.band = nominal_band();
    part.moving = std::string(name) != "wall";
    part.X_WP = part.X_WP_scenario = Pose::translation({x_mm, 0.0, 0.0});
    world.parts.push_back(std::move(part));
  }
  return world;
}

inline constexpr PartId kWall{1}, kRed{2}, kBlue{3};
inline constexpr std::int64_t kSecond_ns = 1'000'000'000;

}  // namespace mortise::testing
