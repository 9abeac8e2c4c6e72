#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "common/depth/body_index.h"
#include "common/geometry/signed_distance.h"
#include "common/geometry/solid.h"
#include "common/geometry/surface_band.h"
#include "common/math/interval.h"
#include "common/math/pose.h"

namespace mortise {

/// The surface of a part that is meant: the mesh, or the least or the largest real surface that the
/// band admits (README, section 3).
enum class Layer : std::uint8_t { kMesh = 0, kLower, kUpper };

/// One part of a depth query with what the search repeatedly needs of its band. Part frame, mm.
struct Body {
  Body(const Solid& solid_of, const SurfaceBand& band_of);

  const Solid* solid;
  const SurfaceBand* band;
  const TriangleMesh* mesh;
  bool has_inside;
  double largest_offset_mm[3] = {0.0, 0.0, 0.0};  ///< by Layer: largest |offset| of any face

  const SurfaceBand::Face& face(std::uint32_t triangle) const { return band->face_of(triangle); }
  std::uint16_t face_index(std::uint32_t triangle) const {
    return band->face_of_triangle.empty() ? std::uint16_t{0} : band->face_of_triangle[triangle];
  }
  const Vec3& normal(std::uint32_t triangle) const { return solid->topology().normal[triangle]; }
  const FaceEnds& ends_of(std::uint16_t face) const;
  /// Extent of a face along the axis of its declared surface, from the surface's point, mm.
  const Interval& extent_of(std::uint16_t face) const { return ends_of(face).extent_mm; }

  /// The face of all triangles below each child of each node of the tree; kMixed: several.
  static constexpr std::int32_t kMixed = -1;
  const std::vector<std::array<std::int32_t, Bvh::kWidth>>& face_of_child() const;

  /// Faces in one plane, merged.
  const PlaneFaces& plane_faces() const;

  /// Does the face's mesh stand for its declared surface at the point nearest to x?
  bool stands_for(std::uint16_t face, const Vec3& x) const;

  /// Triangles around the corners of one that meet its plane at a sharp convex angle and have all
  /// of it on their material side: where they move inward they cut it, where outward they extend
  /// it. One of each declared surface or plane.
  std::span<const std::uint32_t> sharp_neighbours(std::uint32_t triangle) const;
  /// Upper bound of how many more there are. Those that cut the triangle may be left out, as more
  /// of it is kept; those that extend it may not.
  std::uint32_t sharp_left_out(std::uint32_t triangle) const {
    return sharp_range(triangle).left_out;
  }
  static constexpr std::size_t kMostSharp = 8;  ///< a corner of a machine part has two or three

  /// The declared surface that stands for a face in a layer; null: its triangles do.
  static const Surface* surface_of(const SurfaceBand::Face& face, Layer layer);
  /// Outward offset of the layer from that surface or, without one, from the mesh.
  static double offset_of(const SurfaceBand::Face& face, Layer layer);
  /// Bound of the outward offset of the layer from the mesh, anywhere on the face.
  static Interval offset_range_of(const SurfaceBand::Face& face, Layer layer);
  /// Outward offset of the layer at mesh point x of a triangle.
  double offset_at(std::uint32_t triangle, const Vec3& x, Layer layer) const;

  /// Depth of x in the layer, positive inside, given its nearest mesh point: a lower bound where it
  /// is positive (README, section 3). Over a declared face the distance from its surface counts,
  /// exact however coarse the mesh; beyond its facets that, or its triangles with their offsets.
  double depth_in(const Vec3& x, const SurfacePoint& nearest, Layer layer) const;

  BodyIndex& index() const { return *index_; }

 private:
  double depth_by_triangle(const Vec3& x, std::uint32_t triangle,
                           const std::array<Vec3, 3>& corners, bool in_mesh, Layer layer) const;
  const BodyIndex::Range& sharp_range(std::uint32_t triangle) const;
  void find_sharp_neighbours(std::uint32_t triangle) const;
  std::int32_t find_faces_of_children(std::int32_t child) const;
  std::shared_ptr<BodyIndex> index_;
};

}  // namespace mortise
