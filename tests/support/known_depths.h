#pragma once
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/shapes.h"

namespace mortise::shapes {

/// Two meshes whose depth delta is known exactly (research notes 6.2 and 6.3), A in the frame of B.
struct KnownDepth {
  std::string name;
  TriangleMesh a, b;
  double depth_mm = 0.0;
  Vec3 size_mm = Vec3::Ones();  ///< of the larger part, for poses
};

/// n: how finely each is cut from the start.
inline std::vector<KnownDepth> known_depths(int n) {
  const double half_phase = std::numbers::pi / 32;
  std::vector<KnownDepth> all;
  all.push_back({"cubes", box({.5, .5, .5}, Vec3::Zero(), n), box({.5, .5, .5}, {.9, .13, .07}, n),
                 0.1, Vec3::Ones()});
  all.push_back({"deep cubes", box({.5, .5, .5}, Vec3::Zero(), n),
                 box({.5, .5, .5}, {.5, .1, .2}, n), 0.5, Vec3::Ones()});
  all.push_back({"crossing bars", box({5, .5, .5}, Vec3::Zero(), n),
                 box({.5, 5, .5}, {0, 0, .8}, n), 0.2, 10 * Vec3::Ones()});
  all.push_back({"key in slot", box({4, 3, 10}, {0.03, 3.02, 15}, n), u_slot(10, 4, 8, 5, 0, 30),
                 0.03, 30 * Vec3::Ones()});
  all.push_back({"peg half a phase off", peg({10, -5, 15, 32, n, half_phase}),
                 ring({10, 0, 20, 32, n, 0}, 20), 0.04815273327803114, 20 * Vec3::Ones()});
  all.push_back({"peg in phase, 10 um wide", peg({10.01, -5, 15, 32, n, 0}),
                 ring({10, 0, 20, 32, n, 0}, 20), 0.01, 20 * Vec3::Ones()});
  all.push_back({"coarse peg half a phase off", peg({10, -5, 15, 16, n, 2 * half_phase}),
                 ring({10, 0, 20, 16, n, 0}, 20), 0.19214719596769569, 20 * Vec3::Ones()});
  return all;
}

}  // namespace mortise::shapes
