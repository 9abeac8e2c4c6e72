#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "common/depth/body.h"
#include "common/depth/cells/convex_cell.h"

namespace mortise {

/// Outward offsets of a face in the least and in the largest layer, mm.
using LayerOffsets = std::array<double, 2>;

inline LayerOffsets larger(const LayerOffsets& a, const LayerOffsets& b) {
  return {std::max(a[0], b[0]), std::max(a[1], b[1])};
}

/// What a cover is made of: the faces of a part with their offsets (README, section 11).
class CoverFaces {
 public:
  explicit CoverFaces(const Body& body);

  const TriangleMesh& mesh() const { return *body.mesh; }
  std::uint32_t count() const { return static_cast<std::uint32_t>(mesh().triangles.size()); }
  const Surface* surface(std::uint32_t t) const {
    return Body::surface_of(body.face(t), Layer::kUpper);
  }
  LayerOffsets offsets(std::uint32_t t) const;
  /// No real surface of the triangle is farther outside of it.
  double reach_mm(std::uint32_t t) const { return reach_of_face_[body.face_index(t)]; }
  /// The true face is no farther outside of the triangle, without tolerances.
  double bulge_mm(std::uint32_t t) const;
  /// How deep the chords of a face cut into it.
  double chord_mm(std::uint32_t t) const;

  /// The same towards n.
  double reach_mm(std::uint32_t t, const Vec3& n) const;

  /// The border {n · x = c} of what holds or leaves out the part. Offsets are those of the plane
  /// faces that lie in it; without one it is taken farther out by travel_mm. Faces that end on
  /// those are trimmed by them. Of others that come near, with corners on the inner side, none
  /// comes farther out by its own offset: the border is taken farther out.
  struct Border {
    LayerOffsets offsets{};
    std::vector<bool> has_face;   ///< by plane face: lies in the border
    std::vector<bool> has_point;  ///< by point: of such a face
  };
  Border border(const Vec3& n, double c_mm) const;

  bool touches(std::uint32_t t, const std::vector<bool>& points) const;
  /// How a face ends on another one, at these points. One that rises from it a little, or goes on
  /// smoothly, is not trimmed by it.
  enum class Meeting { kNone, kTrimmed, kSmooth, kRising };
  /// normal_at(point): of the other face.
  template <class NormalAt>
  Meeting meeting(std::uint32_t t, const std::vector<bool>& points, NormalAt&& normal_at) const {
    Meeting meeting = Meeting::kNone;
    for (const std::uint32_t p : mesh().triangles[t]) {
      if (!points[p]) continue;
      const Vec3& x = mesh().points_mm[p];
      meeting = std::max(meeting, meeting_at(t, points, x, normal_at(x)));
    }
    return meeting;
  }

  const Body& body;
  const PlaneFaces& planes;
  double same_mm = 0.0;    ///< places nearer to each other are the same
  double travel_mm = 0.0;  ///< the largest part is nowhere farther out of the mesh
  double recess_mm = 0.0;  ///< no face of the least part is farther inside of where it is modelled

 private:
  Vec3 normal(std::uint32_t t, const Vec3& x) const;
  Meeting meeting_at(std::uint32_t t, const std::vector<bool>& points, const Vec3& x,
                     const Vec3& n) const;
  double edge_travel(double most_mm) const;
  std::vector<double> reach_of_face_;
};

/// Leaves of a convex polygon what has n · x > c_mm. `spare`: memory of calls before.
void leave_beyond(std::vector<Vec3>& polygon, const Vec3& n, double c_mm, std::vector<Vec3>& spare);

}  // namespace mortise
