#include "tests/bench/judgement_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/check.h"
#include "tests/support/shapes.h"

namespace mortise::bench {
namespace {

using std::numbers::pi;

void add_feature(JudgedPart& part, const std::string& name, const Surface& surface,
                 const std::vector<std::uint32_t>& triangles) {
  FeatureDeclaration declared;
  declared.name = name;
  declared.surface = surface;
  auto match = check_feature(*part.solid, declared, triangles);
  MORTISE_CHECK(bool(match), "a made part has the surfaces that it was made from");
  part.features.push_back(std::move(match->feature));
}

Surface plane_surface(const Vec3& point, const Vec3& outward) {
  Surface surface;
  surface.kind = SurfaceKind::kPlane;
  surface.point = point;
  surface.axis = outward;
  return surface;
}

void add_plane(JudgedPart& part, const std::string& name, const Vec3& point, const Vec3& outward) {
  const TriangleMesh& mesh = part.solid->mesh();
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
    const Vec3 normal = (b - a).cross(c - a).normalized();
    if (normal.dot(outward) > 0.999 && std::abs(outward.dot(a - point)) < 1e-9)
      triangles.push_back(t);
  }
  add_feature(part, name, plane_surface(point, outward), triangles);
}

}  // namespace

Turning& Turning::line_to(const Point& end, int rows) {
  const Point start = points_.back();
  const std::size_t first = points_.size() - 1;
  for (int j = 1; j <= rows; ++j) {
    const double u = static_cast<double>(j) / rows;
    points_.push_back(j == rows ? end
                                : Point{start.r_mm + u * (end.r_mm - start.r_mm),
                                        start.z_mm + u * (end.z_mm - start.z_mm)});
  }
  pieces_.push_back({first, points_.size() - 1, "", {}});
  return *this;
}

Turning& Turning::arc(double center_z_mm, double from_rad, double to_rad, int rows) {
  const double radius = std::hypot(points_.back().r_mm, points_.back().z_mm - center_z_mm);
  const std::size_t first = points_.size() - 1;
  for (int j = 1; j <= rows; ++j) {
    const double u = from_rad + (to_rad - from_rad) * j / rows;
    const bool pole = j == rows && (to_rad == 0.0 || to_rad == pi);
    points_.push_back({pole ? 0.0 : radius * std::sin(u), center_z_mm - radius * std::cos(u)});
  }
  pieces_.push_back({first, points_.size() - 1, "", {}});
  return *this;
}

Turning& Turning::is(const std::string& name, const Surface& surface) {
  pieces_.back().name = name;
  pieces_.back().surface = surface;
  return *this;
}

JudgedPart Turning::turn(const Around& around) && {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(around.facets);
  // 1. rings; a profile that comes back to its start ends on the ring that it began with
  const bool closed = points_.front().r_mm == points_.back().r_mm &&
                      points_.front().z_mm == points_.back().z_mm && points_.front().r_mm > 0.0;
  std::vector<std::uint32_t> first_of(points_.size());
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (closed && k + 1 == points_.size()) {
      first_of[k] = 0;
      break;
    }
    first_of[k] = static_cast<std::uint32_t>(mesh.points_mm.size());
    const Point& p = points_[k];
    for (std::uint32_t i = 0; i < (p.r_mm > 0.0 ? n : 1); ++i)
      mesh.points_mm.push_back(
          shapes::on_circle(p.r_mm, 2.0 * pi * i / n + around.phase_rad, p.z_mm));
  }
  // 2. walls
  std::vector<std::vector<std::uint32_t>> triangles_of(pieces_.size());
  for (std::size_t f = 0; f < pieces_.size(); ++f)
    for (std::size_t e = pieces_[f].first_edge; e < pieces_[f].end_edge; ++e)
      for (std::uint32_t i = 0; i < n; ++i) {
        const bool below = points_[e].r_mm > 0.0, above = points_[e + 1].r_mm > 0.0;
        const auto at = [&](std::size_t k, bool ring, std::uint32_t j) {
          return first_of[k] + (ring ? j % n : 0);
        };
        const std::uint32_t a = at(e, below, i), b = at(e, below, i + 1);
        const std::uint32_t c = at(e + 1, above, i + 1), d = at(e + 1, above, i);
        const auto add = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
          triangles_of[f].push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
          mesh.triangles.push_back({x, y, z});
        };
        if (below) add(a, b, c);
        if (above) add(a, c, d);
      }
  // 3. features
  JudgedPart part;
  part.facets = around.facets;
  part.solid = shapes::solid(std::move(mesh));
  for (std::size_t f = 0; f < pieces_.size(); ++f)
    if (!pieces_[f].name.empty())
      add_feature(part, pieces_[f].name, pieces_[f].surface, triangles_of[f]);
  return part;
}

Surface cylinder_surface(double radius_mm, bool inward) {
  Surface surface;
  surface.kind = SurfaceKind::kCylinder;
  surface.radius_mm = radius_mm;
  surface.inward = inward;
  return surface;
}

Surface sphere_surface(const Vec3& center, double radius_mm, bool inward) {
  Surface surface;
  surface.kind = SurfaceKind::kSphere;
  surface.point = center;
  surface.radius_mm = radius_mm;
  surface.inward = inward;
  return surface;
}

Surface cone_surface(const Turning::Point& p0, const Turning::Point& p1, bool inward) {
  const double slope = (p1.r_mm - p0.r_mm) / (p1.z_mm - p0.z_mm);
  Surface surface;
  surface.kind = SurfaceKind::kCone;
  surface.point = Vec3(0, 0, p0.z_mm - p0.r_mm / slope);
  surface.axis = slope > 0.0 ? Vec3(Vec3::UnitZ()) : Vec3(-Vec3::UnitZ());
  surface.half_angle_rad = std::atan(std::abs(slope));
  surface.inward = inward;
  return surface;
}

namespace {

Surface wall_surface(const Frustum& f, bool inward) {
  if (f.r0_mm == f.r1_mm) return cylinder_surface(f.r0_mm, inward);
  return cone_surface({f.r0_mm, f.z0_mm}, {f.r1_mm, f.z1_mm}, inward);
}

}  // namespace

JudgedPart make_shaft(const Frustum& f, int rows, const Around& around) {
  Turning turning({0.0, f.z0_mm});
  turning.line_to({f.r0_mm, f.z0_mm});
  turning.line_to({f.r1_mm, f.z1_mm}, rows).is("shaft", wall_surface(f, false));
  turning.line_to({0.0, f.z1_mm});
  return std::move(turning).turn(around);
}

JudgedPart make_ring(const Frustum& f, double outer_mm, int rows, const Around& around) {
  Turning turning({f.r0_mm, f.z0_mm});
  turning.line_to({outer_mm, f.z0_mm});
  turning.line_to({outer_mm, f.z1_mm}).is("outer", cylinder_surface(outer_mm, false));
  turning.line_to({f.r1_mm, f.z1_mm});
  turning.line_to({f.r0_mm, f.z0_mm}, rows).is("bore", wall_surface(f, true));
  JudgedPart part = std::move(turning).turn(around);
  std::swap(part.features[0], part.features[1]);
  return part;
}

JudgedPart make_ball(double radius_mm, const Around& around) {
  Turning turning({0.0, -radius_mm});
  turning.arc(0.0, 0.0, pi, around.facets / 2)
      .is("ball", sphere_surface(Vec3::Zero(), radius_mm, false));
  return std::move(turning).turn(around);
}

JudgedPart make_socket(double radius_mm, double rim_z_mm, double outer_mm, const Around& around) {
  const double angle = std::acos(-rim_z_mm / radius_mm);
  const int rows = std::max(3, static_cast<int>(std::lround(around.facets * angle / (2.0 * pi))));
  Turning turning({0.0, -outer_mm});
  turning.line_to({outer_mm, -outer_mm});
  turning.line_to({outer_mm, rim_z_mm}).is("outer", cylinder_surface(outer_mm, false));
  turning.line_to({radius_mm * std::sin(angle), rim_z_mm});
  turning.arc(0.0, angle, 0.0, rows).is("socket", sphere_surface(Vec3::Zero(), radius_mm, true));
  JudgedPart part = std::move(turning).turn(around);
  std::swap(part.features[0], part.features[1]);
  return part;
}

JudgedPart make_block(const Vec3& half_mm, int n) {
  JudgedPart part;
  part.solid = shapes::solid(shapes::box(half_mm, Vec3::Zero(), n));
  add_plane(part, "left", -half_mm.x() * Vec3::UnitX(), -Vec3::UnitX());
  add_plane(part, "right", half_mm.x() * Vec3::UnitX(), Vec3::UnitX());
  add_plane(part, "bottom", -half_mm.y() * Vec3::UnitY(), -Vec3::UnitY());
  return part;
}

JudgedPart make_slot(const Slot& slot) {
  JudgedPart part;
  const double s = slot.half_width_mm;
  part.solid = shapes::solid(shapes::u_slot(s + slot.wall_mm, s, slot.depth_mm, slot.wall_mm,
                                            -slot.half_length_mm, slot.half_length_mm));
  add_plane(part, "left", -s * Vec3::UnitX(), Vec3::UnitX());
  add_plane(part, "right", s * Vec3::UnitX(), -Vec3::UnitX());
  add_plane(part, "floor", Vec3::Zero(), Vec3::UnitY());
  return part;
}

double chord_error_mm(const JudgedPart& part) {
  double largest = 0.0;
  const TriangleMesh& mesh = part.solid->mesh();
  for (const Feature& feature : part.features) {
    if (feature.surface.kind == SurfaceKind::kPlane) continue;
    for (const std::uint32_t t : feature.triangles) {
      const Interval off = feature.surface.signed_distance_range_mm(
          mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
      largest = std::max({largest, std::abs(off.lo), std::abs(off.hi)});
    }
  }
  return largest;
}

}  // namespace mortise::bench
