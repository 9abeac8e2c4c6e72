#pragma once
#include <cstdint>

/// How far the search for the first interference of a motion goes into detail (real_time.cpp), and
/// when it has done enough.
namespace mortise::search_effort {

// Items are cut down to this share of the accuracy.
inline constexpr double kSmallestShare = 0.25;

// Paths longer than this many widths are cut in time without asking.
inline constexpr double kLongPath = 4.0;

// After the time at which a closed form stops excluding an overlap, so many of the briefest
// intervals are looked at. An overlap that is certain by then counts as certain from that time on.
inline constexpr double kSoon = 256.0;

// After so many evaluations, and again whenever they have doubled, the search looks this many times
// the accuracy of the path ahead whether the parts interfere: a part that the last tick stopped
// stands a little before the contact.
inline constexpr std::uint64_t kFirstLook = 400, kLookWorkCap = 2'000;
inline constexpr double kSoonShare = 4.0;

// After this share of the work cap the proven time may stay this far, mm of path, before a time at
// which the parts interfere: two rims that just meet take ten times the work for the rest.
inline constexpr std::uint64_t kEnoughOfCap = 8, kEnoughLeast = 1'000;
inline constexpr double kCloseEnough_mm = 0.02;

// Steps back, doubling from the accuracy, from a time at which the overlap is already certain; and
// the work of these steps and the search, in work caps, after which the start of the tick is used.
inline constexpr std::uint64_t kBackOff = 12, kBackOffCaps = 2;

}  // namespace mortise::search_effort
