#pragma once
#include <optional>

#include "common/depth/depth.h"
#include "common/depth/search/candidates.h"
#include "common/depth/search/search.h"

namespace mortise {

/// Shape of the face that a triangle belongs to, near x (part frame): from its declared or
/// recognized surface, else from the edges across which it goes on smoothly (concave-convex
/// determination of the paper; geometry/README.md, section 1). A torus is convex (a groove:
/// concave) on the side away from its axis and a saddle on the side towards it. Without a surface,
/// facets that meet at more than kSharpEdge_rad are taken for planes: a coarse round cannot be told
/// from a prism.
FaceShape face_shape(const Body& body, std::uint32_t triangle, const Vec3& x);

/// A point inside both real parts for all their offsets: tried halfway between the deepest point
/// of one least surface and the other, and verified in both parts (README, section 7). World frame.
/// Costs up to some 300 evaluations, where there is none. `refused`, may be null, counts points
/// that the surfaces called inside and a mesh did not bear out.
std::optional<Vec3> find_witness(const PairFrame& pair, const Sample& least,
                                 std::uint64_t& evaluations, std::uint64_t* refused = nullptr);

/// Does the mesh itself bear out that a point (part frame) is inside the least part? The winding
/// number is one there, or the point stands above each triangle at the nearest place of the mesh by
/// no more than what is stated of that triangle. Asks no surface continued beyond its triangles.
bool is_borne_out(const Body& body, const Vec3& x, double rounding_mm);

/// A point inside both meshes, below the faces named.
struct SharedInside {
  Vec3 point_W = Vec3::Zero();
  double depth_mm = 0.0;      ///< the sum of its depths in both
  double in_either_mm = 0.0;  ///< the smaller of the two
  std::uint32_t triangle[2] = {0, 0};
};
/// Below two coinciding faces with the same outward direction.
std::optional<SharedInside> find_shared_inside(const PairFrame& pair, const Candidates& candidates);
/// Of parts of one mesh of which each point lies near its twin: below some of their triangles.
std::optional<SharedInside> find_inside_of_twins(const PairFrame& pair, std::uint64_t& evaluations);
/// The middle of either part, where it is no less than least_mm below the surface of both.
std::optional<SharedInside> find_middle_in_both(const PairFrame& pair, double least_mm,
                                                std::uint64_t& evaluations);

/// Fills in point, normal and faces of the region from the deepest sample.
void describe(const PairFrame& pair, const Sample& deepest, const Sample& deciding,
              OverlapRegion& region);

/// A region of which only is known that its least surfaces are so deep at a point, and at most
/// most_mm; nothing of the meshes.
OverlapRegion region_of_certain(const PairFrame& pair, const Sample& deepest, double most_mm);

/// The shapes of the faces at its place.
void set_shapes(const PairFrame& pair, OverlapRegion& region);

/// The witness, which may be none, and the place from which it was found.
void set_witness(const PairFrame& pair, const std::optional<Vec3>& witness_W, const Sample& from,
                 OverlapRegion& region);

/// Sets values within touch_mm of zero to zero (rounding and the accuracy of first contact).
Interval without_touch(Interval value, double touch_mm);

}  // namespace mortise
