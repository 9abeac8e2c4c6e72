#pragma once
#include <cstdint>
#include <random>

#include "common/math/types.h"

namespace mortise {

/// mt19937_64 is the same everywhere; the library's distributions are not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(engine_() >> 11) * 0x1.0p-53;
  }
  Vec3 in_cube(double half) {
    const double x = uniform(-half, half), y = uniform(-half, half), z = uniform(-half, half);
    return {x, y, z};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace mortise
