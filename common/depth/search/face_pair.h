#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "common/depth/body.h"
#include "common/math/pose.h"

namespace mortise {

inline constexpr Interval kEverywhere_mm{-std::numeric_limits<double>::infinity(),
                                         std::numeric_limits<double>::infinity()};

/// Extent of a face along the axis of its surface, from `point`, mm.
struct FaceExtent {
  double lo_mm = 0.0, hi_mm = 0.0;
  /// By which the face may go on beyond its outermost corners, at the lower and the upper end.
  double beyond_mm[2] = {0.0, 0.0};
  FaceArc around_axis = {}, around_tube = {};  ///< of a torus
};
FaceExtent extent_of(const Body& body, std::uint16_t face, const Surface& surface);

/// Bracket of the overlap of two declared surfaces where both faces are, nominal surfaces, mm: sup
/// of -(s_a + s_b). Frame B.
struct FacePairOverlap {
  double lo_mm = 0.0, hi_mm = 0.0;
  double near_hi_mm = 0.0;      ///< upper end over all that is within the margin of the faces' ends
  Vec3 point_B = Vec3::Zero();  ///< on the surface of the convex face, where lo is reached
  Vec3 normal_B = Vec3::UnitZ();  ///< outward normal of B's face there
  /// lo and hi for each of the layers asked for (see there), without its offsets.
  std::array<Interval, 2> of_layer_mm = {};
  /// The same of both surfaces continued: no point inside the one is deeper below the other. Known
  /// of tubes.
  double continued_hi_mm = std::numeric_limits<double>::infinity();
};

/// Outward offsets of A's and B's surface in a layer, mm.
struct PairOffsets {
  double a_mm = 0.0, b_mm = 0.0;
};

/// Closed form for a shaft in a bore, a cone in a cone (nearly parallel axes; see round_reach), a
/// ball in a socket, and a torus with any round surface (see tube_reach); nothing for other pairs.
/// `margin_mm` is how far beyond its end a face still counts as near. Nothing either where no point
/// of the convex face is within the margin; lo and hi are -infinity where none is within both
/// faces' ends. `layers`, may be null: the brackets are to hold when the offsets of these layers
/// are added; a ball at the rim of its socket is not offset alike.
std::optional<FacePairOverlap> face_pair_overlap(
    const Surface& a, const FaceExtent& extent_a, const Surface& b, const FaceExtent& extent_b,
    const Pose& X_BA, double margin_mm, const std::array<PairOffsets, 2>* layers = nullptr);

/// The largest depth in a ball of a point outside the sphere of its socket, mm, and the heights
/// along the socket's axis between which that holds: the ends of its face and `margin_mm` more.
/// Nothing when it holds nowhere.
struct BeyondSocket {
  double depth_mm = 0.0;
  Interval along_mm;
};
std::optional<BeyondSocket> beyond_socket(const Surface& ball, const Surface& socket,
                                          const FaceExtent& extent_of_socket, double margin_mm);

/// Upper bounds for a convex round face in a bore with a nearly parallel axis, mm: how far the
/// surface of its face (`face_mm`), and any point that is not outside of its surface continued
/// (`within_mm`), may lie beyond the bore's wall, where the bore is near. Infinity: nothing is
/// known. Over time each is convex in the displacement.
///
/// A cone (chamfer, taper) is bounded by its end circles: the distance from the bore's axis is
/// convex. `most_inward_mm` >= 0 is how far the layers may move the round face inward; along a
/// cone's normal that is less in radius.
struct InBoreBound {
  double face_mm = std::numeric_limits<double>::infinity();
  double within_mm = std::numeric_limits<double>::infinity();
  /// As face_mm, beyond the wall continued beyond the bore's ends.
  double along_mm = std::numeric_limits<double>::infinity();
  /// Between these heights along the axis of a's and of b's surface the bounds hold for the surface
  /// continued, too.
  Interval holds_along_mm[2] = {kEverywhere_mm, kEverywhere_mm};
};
struct InBoreQuery {
  const Surface* a = nullptr;
  const Surface* b = nullptr;
  FaceExtent extent_a, extent_b;
  double most_inward_mm = 0.0;
  double margin_mm = 0.0;
};
InBoreBound in_bore_bound(const InBoreQuery& query, const Pose& X_BA);
/// May the pair have such a bound at all?
bool is_round_in_bore(const Surface& a, const Surface& b);

}  // namespace mortise
