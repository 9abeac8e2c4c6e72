#pragma once
#include "common/math/interval.h"

namespace mortise {

/// A bracket wider than this was left open because the class was decided: one of its ends says
/// something, its middle and what is made of it do not. Smaller than any length that is told of a
/// decision, larger than what refinement leaves.
inline constexpr double kBracketOpen_mm = 2e-3;
inline bool is_open(Interval bracket_mm) { return !(bracket_mm.width() <= kBracketOpen_mm); }

}  // namespace mortise
