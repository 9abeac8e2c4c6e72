#pragma once
#include <cstdlib>

namespace mortise::test {

/// How often a random test repeats itself: `normal` times, or MORTISE_EFFORT times as often in a
/// soak (`./mortise test --soak`).
inline int effort(int normal) {
  const char* times = std::getenv("MORTISE_EFFORT");
  const int factor = times != nullptr ? std::atoi(times) : 1;
  return normal * (factor > 0 ? factor : 1);
}

/// Whether case i of those that a test lists, or its longer half, is played: each `every`-th, in a
/// soak all of them.
inline bool plays(int i, int every) { return effort(1) > 1 || i % every == 0; }

/// Whether durations are held to their bounds: only in a soak, where nothing runs beside a test
/// that uses the network.
inline bool timed() { return effort(1) > 1; }

}  // namespace mortise::test
