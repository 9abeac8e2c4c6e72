#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/math/interval.h"
#include "common/math/types.h"
#include "common/messages/feature_info.h"
#include "common/messages/verdict.h"

namespace mortise {

/// The true surface of a face, part frame, mm. `inward` is true for a bore: the material lies
/// outside the radius.
struct Surface {
  SurfaceKind kind = SurfaceKind::kUnknown;
  Vec3 point = Vec3::Zero();    ///< on the plane / on the axis / apex of the cone / centre
  Vec3 axis = Vec3::UnitZ();    ///< unit: plane normal (outward), axis of cylinder, cone (apex to
                                ///< wide), torus
  double radius_mm = 0.0;       ///< cylinder, sphere; torus: of the centre circle
  double tube_radius_mm = 0.0;  ///< torus
  double half_angle_rad = 0.0;  ///< cone
  bool inward = false;  ///< bore, countersink, socket: outward normal points to the axis or centre

  /// Signed distance of x to the true surface, positive on the outside of the material. mm, exact.
  double signed_distance_mm(const Vec3& x) const;
  /// Unit outward normal of the material at the surface point nearest to x.
  Vec3 outward_normal(const Vec3& x) const;
  /// Upper bound of |1/curvature radius| near x: 1/R for a cylinder. 0 for a plane.
  double curvature_bound(const Vec3& x) const;
  /// A distance to a cylinder, cone or sphere, counted from inside the radius, is a convex
  /// function. That to a torus bends the other way around the axis, inside its centre circle. By no
  /// more than this it falls below its tangent at `middle`, or rises above its chords, over the
  /// hull of points grown by more_mm. mm; 0 for other surfaces.
  double concave_bend_mm(const Vec3& middle, std::span<const Vec3> points, double more_mm) const;
  /// Bracket of the signed distance over a whole triangle: contains it, and is wider by about
  /// accuracy_mm (cone of long triangles: by the bend over 1/4096 of its length; torus: by its bend
  /// over the triangle).
  Interval signed_distance_range_mm(const Vec3& a, const Vec3& b, const Vec3& c,
                                    double accuracy_mm = 1e-7) const;
  /// Do the corners of a triangle lie on one circle about the axis, within near_mm? Then it stands
  /// for the flat inside of that circle, not for the cylinder, cone or torus that begins there.
  bool is_cap(const Vec3& a, const Vec3& b, const Vec3& c, double near_mm) const;
  /// Is the signed distance no larger than limit_mm over a whole triangle? True is proven; false
  /// where it is larger, or exceeds the limit by less than the bend of a piece of 1/4096 of it.
  bool stays_below_mm(const Vec3& a, const Vec3& b, const Vec3& c, double limit_mm) const;
};

/// A declared (or recognized) face of a part: its true surface and which triangles of the mesh
/// stand for it.
struct Feature {
  std::string name;
  Surface surface;
  DeviationGrade grade = DeviationGrade::kDeclaredFeature;
  double residual_mm = 0.0;  ///< largest distance of a mesh corner of the face from the surface
  std::vector<std::uint32_t> triangles;
  FeatureOrigin origin = FeatureOrigin::kDeclared;
};

}  // namespace mortise
