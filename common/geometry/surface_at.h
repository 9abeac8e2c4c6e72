#pragma once
#include <cmath>

#include "common/geometry/feature.h"

namespace mortise {

/// A surface made ready for many points: what only depends on the surface is computed once. Keeps a
/// reference to it.
class SurfaceAt {
 public:
  /// The half plane through the axis and x: height z along the axis, distance r from it, and the
  /// unit direction of r (any fixed perpendicular when x lies on the axis).
  struct View {
    double z_mm = 0.0;
    double r_mm = 0.0;
    Vec3 radial = Vec3::UnitX();
  };

  explicit SurfaceAt(const Surface& surface) : s_(surface) {
    if (s_.kind != SurfaceKind::kCone) return;
    cosine_ = std::cos(s_.half_angle_rad);
    sine_ = std::sin(s_.half_angle_rad);
  }

  View view_from_axis(const Vec3& x) const {
    View view;
    const Vec3 d = x - s_.point;
    view.z_mm = d.dot(s_.axis);
    const Vec3 across = d - view.z_mm * s_.axis;
    view.r_mm = across.norm();
    view.radial = view.r_mm > 0.0 ? Vec3(across / view.r_mm) : s_.axis.unitOrthogonal();
    return view;
  }

  /// Foot of x on the cone's generator line, counted from the apex; negative: the apex is nearest.
  double along_generator(double z_mm, double r_mm) const { return z_mm * cosine_ + r_mm * sine_; }

  /// Distance as if the material lay inside the radius.
  double outside_mm(const Vec3& x) const {
    const Vec3 d = x - s_.point;
    if (s_.kind == SurfaceKind::kSphere) return d.norm() - s_.radius_mm;
    if (s_.kind == SurfaceKind::kUnknown) return 0.0;
    const double z = d.dot(s_.axis);
    if (s_.kind == SurfaceKind::kPlane) return z;
    const double r = (d - z * s_.axis).norm();
    if (s_.kind == SurfaceKind::kCylinder) return r - s_.radius_mm;
    if (s_.kind == SurfaceKind::kTorus) return std::hypot(r - s_.radius_mm, z) - s_.tube_radius_mm;
    if (along_generator(z, r) < 0.0) return std::hypot(z, r);
    return r * cosine_ - z * sine_;
  }

  Vec3 outside_normal(const Vec3& x) const {
    const auto unit_or = [](const Vec3& v, const Vec3& otherwise) -> Vec3 {
      const double length = v.norm();
      return length > 0.0 ? Vec3(v / length) : otherwise;
    };
    switch (s_.kind) {
      case SurfaceKind::kCylinder:
        return view_from_axis(x).radial;
      case SurfaceKind::kCone: {
        const View v = view_from_axis(x);
        if (along_generator(v.z_mm, v.r_mm) < 0.0) return unit_or(x - s_.point, -s_.axis);
        return cosine_ * v.radial - sine_ * s_.axis;
      }
      case SurfaceKind::kSphere:
        return unit_or(x - s_.point, s_.axis);
      case SurfaceKind::kTorus: {
        const View v = view_from_axis(x);
        return unit_or((v.r_mm - s_.radius_mm) * v.radial + v.z_mm * s_.axis, v.radial);
      }
      case SurfaceKind::kPlane:
      case SurfaceKind::kUnknown:
        break;
    }
    return s_.axis;
  }

  double signed_distance_mm(const Vec3& x) const {
    return turned() ? -outside_mm(x) : outside_mm(x);
  }
  Vec3 outward_normal(const Vec3& x) const {
    return turned() ? Vec3(-outside_normal(x)) : outside_normal(x);
  }

  const Surface& surface() const { return s_; }

 private:
  bool turned() const { return s_.inward && s_.kind != SurfaceKind::kPlane; }

  const Surface& s_;
  double cosine_ = 1.0, sine_ = 0.0;
};

}  // namespace mortise
