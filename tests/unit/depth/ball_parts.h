#pragma once
#include "tests/support/turned_part.h"
#include "tests/unit/depth/drawn_pairs.h"

/// Balls, pins that end in one, and sockets, each with offset bands of its own.
namespace mortise::cover_parts {

/// Both chains with a name for each of their surfaces; the ends are "lower" and "upper".
inline GeneratedPart turned(const shapes::Chain& outer, const std::vector<std::string>& of_outer,
                            const shapes::Chain& inner, const std::vector<std::string>& of_inner,
                            int facets) {
  GeneratedPart part;
  part.mesh = shapes::turned_part(outer, inner, facets);
  const auto add = [&](const std::string& name, const Surface& surface) {
    part.features.emplace_back();
    part.features.back().name = name;
    part.features.back().surface = surface;
    return &part.features.back();
  };
  part.features.reserve(outer.surfaces.size() + inner.surfaces.size() + 2);
  std::vector<Feature*> of_quad;  // of one facet of the turn, in the order of its quads
  const auto add_chain = [&](const shapes::Chain& chain, const std::vector<std::string>& names) {
    std::size_t s = 0;
    Feature* feature = add(names[0], chain.surfaces[0].surface);
    for (std::size_t i = 0; i + 1 < chain.points.size(); ++i) {
      if (chain.points[i].z >= chain.surfaces[s].z1_mm) {
        ++s;
        feature = add(names[s], chain.surfaces[s].surface);
      }
      of_quad.push_back(feature);
    }
  };
  add_chain(outer, of_outer);
  add_chain(inner, of_inner);
  for (const bool upper : {false, true}) {
    Surface plane;
    plane.kind = SurfaceKind::kPlane;
    plane.axis = upper ? Vec3(Vec3::UnitZ()) : Vec3(-Vec3::UnitZ());
    plane.point = (upper ? outer.points.back() : outer.points.front()).z * Vec3::UnitZ();
    of_quad.push_back(add(upper ? "upper" : "lower", plane));
  }
  for (std::uint32_t t = 0; t < part.mesh.triangles.size(); ++t)
    of_quad[t / 2 % of_quad.size()]->triangles.push_back(t);
  return part;
}

/// All of a ball.
inline DrawnPart ball(Random& random, double r_mm) {
  GeneratedPart whole;
  whole.mesh = shapes::sphere(r_mm, Vec3::Zero(), 8 + 4 * below(random, 5));
  Surface surface;
  surface.kind = SurfaceKind::kSphere;
  surface.radius_mm = r_mm;
  Feature feature;
  feature.name = "ball";
  feature.surface = surface;
  for (std::uint32_t t = 0; t < whole.mesh.triangles.size(); ++t) feature.triangles.push_back(t);
  whole.features.push_back(feature);
  DrawnPart part = finish(random, std::move(whole), 0.03);
  part.round_mm = r_mm;
  part.length_mm = 0.05;
  part.depth = [=](const Vec3& x, const OffsetOf& o) { return r_mm + o("ball") - x.norm(); };
  part.what = "ball";
  return part;
}

/// A ball with a bore, cut off above, on a neck or cut off below as well.
inline DrawnPart stud(Random& random, double r_mm) {
  const bool has_neck = below(random, 2) == 0;
  const double low = has_neck ? std::acos(uniform(random, 0.3, 0.95)) : uniform(random, 0.5, 1.2);
  const double high = uniform(random, 0.9, 1.35), bore = 0.5 * r_mm * std::cos(high);
  const double neck = r_mm * std::cos(low), joint = -r_mm * std::sin(low);
  const double top = r_mm * std::sin(high);
  const double bottom = joint - (has_neck ? uniform(random, 3.0, 12.0) : 0.0);
  shapes::Chain outer, inner;
  inner.inward = true;
  outer.start(neck, bottom);
  if (has_neck) outer.line(neck, joint);
  outer.arc(0.0, 0.0, high, 6 + below(random, 12));
  inner.start(bore, bottom).line(bore, top);
  const std::vector<std::string> names =
      has_neck ? std::vector<std::string>{"neck", "ball"} : std::vector<std::string>{"ball"};
  DrawnPart part =
      finish(random, turned(outer, names, inner, {"bore"}, 12 + 4 * below(random, 12)), 0.03);
  part.round_mm = r_mm;
  part.length_mm = 0.05;
  part.depth = [=](const Vec3& x, const OffsetOf& o) {
    double d = r_mm + o("ball") - x.norm();
    if (has_neck) d = std::max(d, std::min(neck + o("neck") - radius(x), -x.z()));
    return std::min(
        {d, x.z() - bottom + o("lower"), top + o("upper") - x.z(), radius(x) - bore + o("bore")});
  };
  part.what = has_neck ? "stud" : "bead";
  return part;
}

/// A pin with a flat dome, and a bore.
inline DrawnPart domed_pin(Random& random, double r_mm) {
  const double dome = r_mm * uniform(random, 1.05, 6.0), edge = std::acos(r_mm / dome);
  const double high = uniform(random, edge + 0.1 * (0.5 * std::numbers::pi - edge), 1.45);
  const double end = std::max(high, edge + 0.02), bore = 0.5 * dome * std::cos(end);
  const double joint = dome * std::sin(edge), top = dome * std::sin(end);
  // Sometimes the ball of the dome meets the other end of the pin, which it does not trim.
  const bool meets_end = below(random, 3) == 0 && joint > 1.0;
  const double bottom = meets_end ? -joint : joint - uniform(random, 5.0, 25.0);
  shapes::Chain outer, inner;
  inner.inward = true;
  outer.start(r_mm, bottom).line(r_mm, joint).arc(0.0, 0.0, end, 4 + below(random, 8));
  inner.start(bore, bottom).line(bore, top);
  DrawnPart part = finish(
      random, turned(outer, {"pin", "dome"}, inner, {"bore"}, 12 + 4 * below(random, 12)), 0.03);
  part.round_mm = r_mm;
  part.length_mm = top - bottom;
  part.depth = [=](const Vec3& x, const OffsetOf& o) {
    const double d = std::min({r_mm + o("pin") - radius(x), x.z() - bottom + o("lower"),
                               top + o("upper") - x.z(), radius(x) - bore + o("bore")});
    return x.z() < 0.0 ? d : std::min(d, dome + o("dome") - x.norm());
  };
  part.what = "domed pin";
  return part;
}

/// A ring whose hole is a zone of a ball.
inline DrawnPart ball_socket(Random& random, double r_mm) {
  const double low = -uniform(random, 0.3, 1.3), high = uniform(random, -0.1, 0.8);
  const double z0 = r_mm * std::sin(low), z1 = r_mm * std::sin(high);
  shapes::Chain outer, hole;
  hole.inward = true;
  hole.start(r_mm * std::cos(low), z0).arc(0.0, 0.0, high, 6 + below(random, 12));
  outer.start(1.5 * r_mm, z0).line(1.5 * r_mm, z1);
  DrawnPart part =
      finish(random, turned(outer, {"outer"}, hole, {"socket"}, 12 + 4 * below(random, 12)), 0.03);
  part.round_mm = r_mm;
  part.length_mm = 0.05;
  part.depth = [=](const Vec3& x, const OffsetOf& o) {
    return std::min({1.5 * r_mm + o("outer") - radius(x), x.z() - z0 + o("lower"),
                     z1 + o("upper") - x.z(), x.norm() - r_mm + o("socket")});
  };
  part.what = "ball socket";
  return part;
}

/// A ring whose hole is a cone; a ball of that radius sits on the middle of it, sitting_z_mm above
/// the origin.
inline DrawnPart cone_seat(Random& random, double ball_mm, double& sitting_z_mm) {
  const double half = uniform(random, 0.35, 1.2), slope = std::tan(half);
  const double contact = ball_mm * std::cos(half), narrow = 0.5 * contact, wide = 1.4 * contact;
  const double top = (wide - narrow) / slope, outside = 2.0 * wide;
  sitting_z_mm = (contact - narrow) / slope + ball_mm * std::sin(half);
  shapes::Chain outer, hole;
  hole.inward = true;
  hole.start(narrow, 0.0).line(wide, top);
  outer.start(outside, 0.0).line(outside, top);
  DrawnPart part =
      finish(random, turned(outer, {"outer"}, hole, {"cone"}, 12 + 4 * below(random, 12)), 0.03);
  part.round_mm = narrow;
  part.length_mm = top;
  part.depth = [=](const Vec3& x, const OffsetOf& o) {
    return std::min({outside + o("outer") - radius(x), x.z() + o("lower"), top + o("upper") - x.z(),
                     std::cos(half) * (radius(x) - narrow - slope * x.z()) + o("cone")});
  };
  part.what = "cone seat";
  return part;
}

/// A ball on its seat, or a little off it.
inline DrawnPair seated_ball(Random& random) {
  const double r = uniform(random, 3.0, 12.0);
  double z_mm = 0.0;
  DrawnPair pair{ball(random, r), cone_seat(random, r, z_mm), Pose()};
  pair.X_BA.q = rotation_exp(uniform(random, 0.0, 3.1) * any_direction(random));
  pair.X_BA.p = Vec3(0.0, 0.0, z_mm) + uniform(random, 0.0, 0.15) * any_direction(random);
  return pair;
}

/// One of them beside any other part.
inline DrawnPair ball_pair(Random& random) {
  const double r = uniform(random, 3.0, 12.0), other_r = r + uniform(random, -0.05, 0.1);
  DrawnPart (*const round[])(Random&, double) = {ball, stud, domed_pin};
  const DrawnPart a = round[below(random, 3)](random, r);
  const DrawnPart b = below(random, 2) == 0   ? ball_socket(random, other_r)
                      : below(random, 2) == 0 ? socket(random, uniform(random, 0.5, 1.0) * r)
                                              : any_part(random, other_r);
  return placed(random, a, b);
}

}  // namespace mortise::cover_parts
