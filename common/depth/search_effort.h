#pragma once
#include <cstdint>

/// How far the search for the first interference of a motion goes into detail (real_time.cpp), and
/// when it has done enough.
namespace mortise::search_effort {

// Items are cut down to this share of the accuracy.
inline constexpr double kSmallestShare = 0.25;

// Paths longer than this many widths are cut in time without asking.
inline constexpr double kLongPath = 4.0;

// A closed form that stops excluding an overlap is followed by so many of the briefest intervals:
// certain by then, it is so from there on as far as the search goes.
inline constexpr double kSoon = 256.0;

// After so many evaluations, and again when they have doubled, it is asked whether the parts are
// about to interfere: this many times the accuracy of the path on. Where the last tick stopped it,
// a part stands a little before.
inline constexpr std::uint64_t kFirstLook = 400, kLookWorkCap = 2'000;
inline constexpr double kSoonShare = 4.0;

// After this share of the work cap what is proven need not come closer than this, mm of path, to a
// time at which the parts do interfere: two rims at the brink take ten times the work for the rest.
inline constexpr std::uint64_t kEnoughOfCap = 8, kEnoughLeast = 1'000;
inline constexpr double kCloseEnough_mm = 0.02;

// Steps back, doubling from the accuracy, from a time at which the overlap is certain already;
// and the work of them and the search, in work caps, after which it is the start that counts.
inline constexpr std::uint64_t kBackOff = 12, kBackOffCaps = 2;

}  // namespace mortise::search_effort
