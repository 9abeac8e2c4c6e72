#pragma once
#include <cmath>

#include "common/base/constants.h"

/// Ranges of numbers that come in from outside: from scenarios, plays, commands, the wire, logs.
/// What passes a door lies within them, and nothing behind it can overflow.
namespace mortise {

/// Longest length, mm (a thousand kilometres), of a pose, a size, a step or a tolerance: a double
/// there still resolves a nanometre, and what a session adds to it stays below
/// kLargestCoordinate_mm.
inline constexpr double kLongest_mm = 1e9;
static_assert(kLongest_mm * 2.0 * kUnitRoundoff < 1e-6 && kLongest_mm < kLargestCoordinate_mm);

/// Shortest size, mm: a nanometre. Below it nothing is made or measured, and squares and quotients
/// of sizes stay normal numbers.
inline constexpr double kShortest_mm = 1e-6;

/// Largest coordinate of a mesh in its own frame, mm (ten kilometres): beyond it doubles resolve
/// less than a nanometre in the engine's products, and no part is so large; a wrong unit is. At
/// every door for meshes: files, STEP, uploads, the library's API. kLargestCoordinate_mm, which is
/// larger, is what the engine takes, and what it reads of its own states and logs.
inline constexpr double kLongestInPart_mm = 1e7;

/// Largest number of any other kind.
inline constexpr double kLargestNumber = 1e9;

/// Longest time, s (30 years): as ticks and as nanoseconds it fits into 63 bits.
inline constexpr double kLongest_s = 1e9;

/// False for what is not finite.
inline bool within(double x, double most) { return std::fabs(x) <= most; }

}  // namespace mortise
