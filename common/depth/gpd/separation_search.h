#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/ccd/ccd_scratch.h"
#include "common/depth/gpd/minimax.h"

namespace mortise::gpd {

/// Where motions are looked for. kNear: the starts as they are, and pushes from where the parts
/// stand. kFar: sweeps from afar, turns, and descents from the best of them.
enum class Looking : std::uint8_t { kNear, kFar, kEverywhere };

/// Part A is moved, B stays. World frame.
struct SeparationQuery {
  const Solid* a = nullptr;
  const Solid* b = nullptr;
  Pose X_WA, X_WB;
  std::span<const Vec3> directions;  ///< tried first, both ways: normals and axes of what overlaps
  std::span<const Vec6> starts;      ///< twists that may part them, about TwistFrame(a, X_WA)
  double least_mm = 0.0;  ///< no motion that parts them is known to be shorter; scale of the search
  double enough_mm = 0.0;  ///< a motion of this length ends the search
  bool thorough = false;   ///< turns and random twists as well
  Looking looking = Looking::kEverywhere;
  bool first_is_descended = false;  ///< the first start is the end of a descent, and parts them
  std::uint64_t work_cap = std::numeric_limits<std::uint64_t>::max();
};

/// A motion of constant twist that parts A from B, verified at its end: the surfaces do not cross,
/// neither part contains the other.
struct Separation {
  bool found = false;
  double length_mm = std::numeric_limits<double>::infinity();  ///< longest path of any point of A
  Vec6 xi = Vec6::Zero();                                      ///< about TwistFrame(a, X_WA)
  std::uint64_t work = 0;  ///< in units of about an evaluation of the overlap search
};

/// Looks for the shortest one (README, section 7): pushes out, sweeps back from afar, descends by
/// linear rows of the contact places. Deterministic. A local optimum: an upper bound of the depth.
Separation find_separation(const SeparationQuery& query, CcdScratch& scratch);

/// Is A, moved by exp(ξ), apart from B? Touching to rounding counts as not apart.
bool is_apart(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
              CcdScratch& scratch);

}  // namespace mortise::gpd
