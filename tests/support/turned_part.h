#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "common/geometry/feature.h"
#include "tests/support/shapes.h"

/// Turned parts with known surfaces: an outer and an inner chain of corners (r, z), z rising,
/// turned about z by a whole or part of a turn. Every corner lies exactly on its surface.
namespace mortise::shapes {

struct ChainPoint {
  double r = 0.0, z = 0.0;
};

/// A surface that a chain has between two heights.
struct TurnedSurface {
  Surface surface;
  double z0_mm = 0.0, z1_mm = 0.0;
};

struct Chain {
  std::vector<ChainPoint> points;
  std::vector<TurnedSurface> surfaces;
  bool inward = false;

  Chain& start(double r, double z) {
    points.push_back({r, z});
    return *this;
  }
  /// Straight to (r, z): a cylinder or cone.
  Chain& line(double r, double z) {
    const ChainPoint from = points.back();
    Surface s;
    s.inward = inward;
    if (r == from.r) {
      s.kind = SurfaceKind::kCylinder;
      s.radius_mm = r;
    } else {
      const double slope = (r - from.r) / (z - from.z);
      s.kind = SurfaceKind::kCone;
      s.axis = slope > 0.0 ? Vec3(Vec3::UnitZ()) : Vec3(-Vec3::UnitZ());
      s.half_angle_rad = std::atan(std::fabs(slope));
      s.point = Vec3(0, 0, from.z - from.r / slope);
    }
    surfaces.push_back({s, from.z, z});
    points.push_back({r, z});
    return *this;
  }
  /// Along the circle about (center_r, center_z) from where the chain ends to angle `to_rad`
  /// (counted from the r axis), in equal steps. center_r 0: a sphere, else a torus.
  Chain& arc(double center_r, double center_z, double to_rad, int steps) {
    const ChainPoint from = points.back();
    const double radius = std::hypot(from.r - center_r, from.z - center_z);
    const double from_rad = std::atan2(from.z - center_z, from.r - center_r);
    for (int i = 1; i <= steps; ++i) {
      const double a = from_rad + (to_rad - from_rad) * i / steps;
      points.push_back({center_r + radius * std::cos(a), center_z + radius * std::sin(a)});
    }
    Surface s;
    s.kind = center_r == 0.0 ? SurfaceKind::kSphere : SurfaceKind::kTorus;
    s.point = Vec3(0, 0, center_z);
    s.radius_mm = center_r == 0.0 ? radius : center_r;
    s.tube_radius_mm = center_r == 0.0 ? 0.0 : radius;
    s.inward = inward;
    surfaces.push_back({s, from.z, points.back().z});
    return *this;
  }
};

/// The closed part between the chains; both start at the same height and end at the same height.
/// facets: steps of a whole turn, or of the part turn when arc_rad is less.
inline TriangleMesh turned_part(const Chain& outer, const Chain& inner, int facets,
                                double arc_rad = 2.0 * std::numbers::pi) {
  const bool closed = arc_rad >= 2.0 * std::numbers::pi;
  const auto columns = static_cast<std::uint32_t>(closed ? facets : facets + 1);
  TriangleMesh mesh;
  const auto add_chain = [&](const Chain& chain) {
    const auto base = static_cast<std::uint32_t>(mesh.points_mm.size());
    for (std::uint32_t i = 0; i < columns; ++i)
      for (const ChainPoint& p : chain.points) {
        const double a = arc_rad * i / facets;
        mesh.points_mm.emplace_back(p.r * std::cos(a), p.r * std::sin(a), p.z);
      }
    return base;
  };
  const std::uint32_t out = add_chain(outer), in = add_chain(inner);
  const auto rows_out = static_cast<std::uint32_t>(outer.points.size());
  const auto rows_in = static_cast<std::uint32_t>(inner.points.size());
  const auto at = [&](bool o, std::uint32_t column, std::uint32_t row) {
    return (o ? out + column % columns * rows_out : in + column % columns * rows_in) + row;
  };
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(facets); ++i) {
    for (std::uint32_t j = 0; j + 1 < rows_out; ++j)
      add_quad(mesh, at(true, i, j), at(true, i + 1, j), at(true, i + 1, j + 1),
               at(true, i, j + 1));
    for (std::uint32_t j = 0; j + 1 < rows_in; ++j)
      add_quad(mesh, at(false, i, j), at(false, i, j + 1), at(false, i + 1, j + 1),
               at(false, i + 1, j));
    add_quad(mesh, at(true, i, 0), at(false, i, 0), at(false, i + 1, 0), at(true, i + 1, 0));
    add_quad(mesh, at(true, i, rows_out - 1), at(true, i + 1, rows_out - 1),
             at(false, i + 1, rows_in - 1), at(false, i, rows_in - 1));
  }
  if (closed) return mesh;
  for (const bool first : {true, false}) {  // the two flat ends, a strip between the chains
    const std::uint32_t column = first ? 0 : static_cast<std::uint32_t>(facets);
    for (std::uint32_t i = 0, j = 0; i + 1 < rows_out || j + 1 < rows_in;) {
      const bool on_outer =
          j + 1 == rows_in || (i + 1 < rows_out && outer.points[i + 1].z <= inner.points[j + 1].z);
      const std::uint32_t a = at(true, column, i), b = at(false, column, j);
      const std::uint32_t c = on_outer ? at(true, column, ++i) : at(false, column, ++j);
      if (first)
        mesh.triangles.push_back({a, c, b});
      else
        mesh.triangles.push_back({a, b, c});
    }
  }
  return mesh;
}

inline Surface moved(Surface s, const Pose& X) {
  s.point = X * s.point;
  s.axis = X.q * s.axis;
  return s;
}

}  // namespace mortise::shapes
