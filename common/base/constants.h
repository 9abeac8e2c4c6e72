#pragma once
#include <cstddef>
#include <cstdint>

/// Numerical constants that several rooms share: value, unit, reason, reader. A constant of one
/// file stands in that file, with its reason.
namespace mortise {

/// Unit round-off of double, 2^-53.
inline constexpr double kUnitRoundoff = 1.1102230246251565e-16;

/// Rounding allowance of a pair-local coordinate, in units of round-off times extent (L + D, mesh
/// extent plus distance of the frames). 8 covers forming the coordinates, 12 a test along a
/// direction; 32 leaves room for both bodies. Read by ccd and depth. Smaller: contacts may be found
/// a few ulp late.
inline constexpr double kRoundingFactor = 32.0;

/// Default distance at which two meshes count as touching, mm. Far below any tolerance of ISO 286
/// (IT01 is 3e-4 mm), far above rounding at 1 m (7e-12 mm). Read by ccd.
inline constexpr double kAccuracyDefault_mm = 1e-6;

/// Width to which a depth bracket is refined when a caller asks for the full bracket, mm. A tenth
/// of a micrometre.
inline constexpr double kDepthAccuracyDefault_mm = 1e-4;

/// Largest coordinate of a mesh or a pose, mm (a million kilometres). Squares of such lengths and
/// speeds stay far inside single precision, in which boxes are compared. Read by geometry, math.
inline constexpr double kLargestCoordinate_mm = 1e12;

/// How far a quaternion may be from unit length and still be taken for a rotation: far above the
/// rounding of a file with seven digits, far below what would be seen. Read by math.
inline constexpr double kUnitSlack = 1e-6;

/// Largest rotation of one increment, rad. A rotation vector cannot say more than half a turn.
inline constexpr double kMaxRotationPerTick_rad = 3.14159265358979323846;

/// Edges with a larger exterior angle are sharp, rad (30 degrees, the default of CAD tessellators
/// lies just below).
inline constexpr double kSharpEdge_rad = 0.52359877559829887;

/// Facets that meet at no more than this may stand for one smooth surface, rad (35 degrees: rounds
/// of 12 facets turn by 30, octagons and chamfers by 45). A prism of twelve flats and a round of
/// twelve facets cannot be told apart; it counts as round. Read by recognition and estimate.
inline constexpr double kSmoothEdge_rad = 0.61086523819801535;

/// Factor on estimated mesh deviations, which are never called guaranteed.
inline constexpr double kEstimatedDeviationFactor = 1.5;

/// Work cap of one first-contact query, in box tests of eight children. Reached only by threads at
/// large rotation.
inline constexpr std::uint64_t kCcdWorkCap = 2'000'000;

/// A clash ends only when its parts are proven this far from interfering, and its class falls only
/// when this far beyond the threshold, mm. Twice the width of a depth bracket, so that the search
/// for the depth cannot make a resting contact flicker; far below any tolerance. Read by session.
inline constexpr double kClashHysteresis_mm = 2e-4;
static_assert(kClashHysteresis_mm >= 2.0 * kDepthAccuracyDefault_mm);

/// Where the thresholds are farther apart the hysteresis is this share of their distance
/// (session/README.md, section 6), up to so much, mm: a part that is held by hand and trembles must
/// not make an event a tick.
inline constexpr double kClashHysteresisShare = 0.01;
inline constexpr double kClashHysteresisMost_mm = 1e-3;
static_assert(kClashHysteresis_mm <= kClashHysteresisMost_mm);

/// A clash that only grows deeper is told again when its worst depth grew by this share, and not
/// sooner than this many ticks after its last event (a quarter of a second at 60 Hz). Read by
/// session.
inline constexpr double kClashGrowthShare = 0.1;
inline constexpr std::uint64_t kClashQuietTicks = 15;

/// Moves of one part that can be undone, and as many that can be repeated: more is forgotten, the
/// oldest first, so that a session of days does not grow. Read by session/move_history.
inline constexpr std::size_t kMostUndoMoves = 64;

/// How far a part that already interferes may be pressed deeper before policy stop holds it, mm.
/// Ten depth brackets, so that sliding at constant depth is not held by the search's own width. The
/// limit is from the least depth seen: repeated pushes cannot add up. Read by session.
inline constexpr double kDeepeningSlack_mm = 1e-3;

}  // namespace mortise
