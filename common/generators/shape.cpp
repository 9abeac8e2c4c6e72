#include "common/generators/shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mortise {

int Shape::declare(Feature feature) {
  part_.features.push_back(std::move(feature));
  return static_cast<int>(part_.features.size()) - 1;
}

int Shape::plane(const std::string& name, const Vec3& on_plane, const Vec3& outward) {
  Feature feature;
  feature.name = name;
  feature.grade = DeviationGrade::kPlanar;
  feature.surface.kind = SurfaceKind::kPlane;
  feature.surface.point = on_plane;
  feature.surface.axis = outward;
  return declare(feature);
}

int Shape::cylinder(const std::string& name, const Vec3& on_axis, double radius_mm, bool inward) {
  Feature feature;
  feature.name = name;
  feature.surface.kind = SurfaceKind::kCylinder;
  feature.surface.point = on_axis;
  feature.surface.radius_mm = radius_mm;
  feature.surface.inward = inward;
  return declare(feature);
}

int Shape::cone(const std::string& name, const Vec3& apex, const Vec3& axis, double half_angle_rad,
                bool inward) {
  Feature feature;
  feature.name = name;
  feature.surface.kind = SurfaceKind::kCone;
  feature.surface.point = apex;
  feature.surface.axis = axis;
  feature.surface.half_angle_rad = half_angle_rad;
  feature.surface.inward = inward;
  return declare(feature);
}

std::uint32_t Shape::point(const Vec3& p) {
  const std::array<double, 3> key = {p.x() + 0.0, p.y() + 0.0, p.z() + 0.0};
  const auto [found, is_new] =
      number_.emplace(key, static_cast<std::uint32_t>(part_.mesh.points_mm.size()));
  if (is_new) part_.mesh.points_mm.push_back({key[0], key[1], key[2]});
  return found->second;
}

void Shape::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, int face) {
  if (a == b || b == c || c == a) return;
  if (face != kNoFace)
    part_.features[static_cast<std::size_t>(face)].triangles.push_back(
        static_cast<std::uint32_t>(part_.mesh.triangles.size()));
  part_.mesh.triangles.push_back({a, b, c});
}

void Shape::quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, int face) {
  triangle(a, b, c, face);
  triangle(a, c, d, face);
}

Ring Shape::ring(const Loop& loop, double z_mm) {
  Ring ring;
  for (const Vec2& p : loop) ring.push_back(point({p.x(), p.y(), z_mm}));
  return ring;
}

void Shape::facet(const Ring& from, const Ring& to, std::size_t i, int face) {
  const std::size_t j = i + 1;
  quad(from[i % from.size()], from[j % from.size()], to[j % to.size()], to[i % to.size()], face);
}

void Shape::strip(const Ring& from, const Ring& to, int face) {
  for (std::size_t i = 0; i < std::max(from.size(), to.size()); ++i) facet(from, to, i, face);
}

void Shape::cap(const Ring& outline, const std::vector<Ring>& holes, bool up, int face) {
  const auto flat = [&](const Ring& ring, bool turned) {
    Loop loop;
    for (const std::uint32_t i : ring) loop.push_back(at(i).head<2>());
    if (turned) std::reverse(loop.begin(), loop.end());
    return loop;
  };
  Ring all = outline;
  std::vector<Loop> hole_loops;
  for (const Ring& hole : holes) {
    all.insert(all.end(), hole.rbegin(), hole.rend());
    hole_loops.push_back(flat(hole, true));
  }
  const auto triangles = triangulate(flat(outline, false), hole_loops);
  if (!triangles) {
    if (trouble_.empty()) trouble_ = triangles.error().text;
    return;
  }
  for (const auto& t : *triangles)
    up ? triangle(all[t[0]], all[t[1]], all[t[2]], face)
       : triangle(all[t[0]], all[t[2]], all[t[1]], face);
}

Result<GeneratedPart> Shape::finish() && {
  if (!trouble_.empty()) return fail(Code::kInvalidInput, trouble_);
  for (Feature& feature : part_.features)
    for (const std::uint32_t t : feature.triangles)
      for (int k = 0; k < 3; ++k)
        feature.residual_mm =
            std::max(feature.residual_mm,
                     std::abs(feature.surface.signed_distance_mm(part_.mesh.corner(t, k))));
  return std::move(part_);
}

Loop circle(const Vec2& center, double radius_mm, int facets, double phase_rad) {
  Loop loop;
  for (int i = 0; i < facets; ++i) {
    const double angle = phase_rad + 2.0 * std::numbers::pi * i / facets;
    loop.push_back(center + radius_mm * Vec2(std::cos(angle), std::sin(angle)));
  }
  return loop;
}

Loop rectangle(const Vec2& lo, const Vec2& hi) {
  return {lo, {hi.x(), lo.y()}, hi, {lo.x(), hi.y()}};
}

SlottedCircle slotted_circle(double radius_mm, int facets, double phase_rad, double slot_width_mm,
                             double floor_x_mm) {
  const double half = 0.5 * slot_width_mm;
  const double edge_x = std::sqrt(radius_mm * radius_mm - half * half);
  const double edge_rad = std::asin(half / radius_mm);
  // Corners nearer to an edge of the slot than this would make slivers; the edge stands for them.
  const double near_rad = 1e-3 * 2.0 * std::numbers::pi / facets;
  struct Corner {
    double angle;
    Vec2 p;
  };
  std::vector<Corner> outside, inside;
  for (int i = 0; i < facets; ++i) {
    const double angle =
        std::remainder(phase_rad + 2.0 * std::numbers::pi * i / facets, 2.0 * std::numbers::pi);
    if (std::abs(std::abs(angle) - edge_rad) <= near_rad) continue;
    const Corner corner{angle, radius_mm * Vec2(std::cos(angle), std::sin(angle))};
    (std::abs(angle) < edge_rad ? inside : outside).push_back(corner);
  }
  const auto by_angle = [](const Corner& a, const Corner& b) { return a.angle < b.angle; };
  std::sort(inside.begin(), inside.end(), by_angle);
  for (Corner& corner : outside)
    if (corner.angle < 0.0) corner.angle += 2.0 * std::numbers::pi;
  std::sort(outside.begin(), outside.end(), by_angle);

  SlottedCircle slotted;
  const Vec2 lower(edge_x, -half), upper(edge_x, half);
  for (const Corner& corner : outside) slotted.loop.push_back(corner.p);
  slotted.slot_begin = slotted.loop.size();
  for (const Vec2& p : {lower, Vec2(floor_x_mm, -half), Vec2(floor_x_mm, half), upper})
    slotted.loop.push_back(p);
  slotted.arc.push_back(lower);
  for (const Corner& corner : inside) slotted.arc.push_back(corner.p);
  slotted.arc.push_back(upper);
  return slotted;
}

Loop unslotted(const SlottedCircle& slotted) {
  Loop loop(slotted.loop.begin(),
            slotted.loop.begin() + static_cast<std::ptrdiff_t>(slotted.slot_begin));
  loop.insert(loop.end(), slotted.arc.begin(), slotted.arc.end());
  return loop;
}

}  // namespace mortise
