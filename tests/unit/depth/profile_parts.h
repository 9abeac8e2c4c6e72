#pragma once
#include "tests/unit/depth/cover_parts.h"

/// Shafts that are not round, and plates with holes for them, each with offset bands of its own.
namespace mortise::cover_parts {

/// The sides of a profile: corners, the side from each to the next one, and what a point of the
/// plane is below all of them, from the drawing.
struct DrawnProfile {
  Loop loop;
  std::vector<std::string> side;
  std::function<double(const Vec3&, const OffsetOf&)> below;  ///< offsets: outwards of it
  std::function<int(Shape&, const std::string&, bool inward)> face;
  bool together = false;  ///< all sides have one offset
  double round_mm = 0.0;
};

/// A circle with one or two flats.
inline DrawnProfile flattened(double r_mm, double flat_mm, bool two, int facets) {
  DrawnProfile p;
  const double edge = std::acos(flat_mm / r_mm);
  const auto arc = [&](double from, double to, int count) {
    for (int i = 0; i <= count; ++i) {
      const double a = from + (to - from) * i / count;
      p.loop.push_back({r_mm * std::cos(a), r_mm * std::sin(a)});
      p.side.push_back("seat");
    }
  };
  if (two) {
    arc(edge, std::numbers::pi - edge, facets / 2);
    p.side.back() = "flat2";
    arc(std::numbers::pi + edge, 2.0 * std::numbers::pi - edge, facets / 2);
  } else {
    arc(edge, 2.0 * std::numbers::pi - edge, facets);
  }
  p.side.back() = "flat1";
  p.below = [=](const Vec3& x, const OffsetOf& o) {
    const double d = std::min(r_mm + o("seat") - radius(x), flat_mm + o("flat1") - x.x());
    return two ? std::min(d, flat_mm + o("flat2") + x.x()) : d;
  };
  p.face = [=](Shape& shape, const std::string& name, bool inward) {
    if (name == "seat") return shape.cylinder(name, Vec3::Zero(), r_mm, inward);
    const Vec3 out = name == "flat1" ? Vec3::UnitX() : Vec3(-Vec3::UnitX());
    return shape.plane(name, flat_mm * out, inward ? Vec3(-out) : out);
  };
  p.round_mm = r_mm;
  return p;
}

/// A rectangle with round corners; an obround where they leave two sides.
inline DrawnProfile rounded(double a_mm, double b_mm, double r_mm, int facets) {
  DrawnProfile p;
  p.together = true;
  const double signs[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
  const bool obround = r_mm >= b_mm;
  const int arcs = obround ? 2 : 4;
  for (int k = 0; k < arcs; ++k)
    for (int i = 0; i <= facets; ++i) {
      const double t = 2.0 * std::numbers::pi / arcs * (k + double(i) / facets) -
                       (obround ? 0.5 * std::numbers::pi : 0.0);
      p.loop.push_back({signs[k][0] * (a_mm - r_mm) + r_mm * std::cos(t),
                        (obround ? 0.0 : signs[k][1] * (b_mm - r_mm)) + r_mm * std::sin(t)});
      const int beyond = obround ? 2 * k : k;
      p.side.push_back(i < facets ? "corner" + std::to_string(k) : "side" + std::to_string(beyond));
    }
  p.below = [=](const Vec3& x, const OffsetOf& o) {
    const double u = std::fabs(x.x()) - (a_mm - r_mm), v = std::fabs(x.y()) - (b_mm - r_mm);
    const double outside = std::hypot(std::max(u, 0.0), std::max(v, 0.0));
    return r_mm - outside - std::min(std::max(u, v), 0.0) + o("side0");
  };
  p.face = [=](Shape& shape, const std::string& name, bool inward) {
    const int k = name.back() - '0';
    if (name.rfind("corner", 0) == 0) {
      const double y = obround ? 0.0 : signs[k][1] * (b_mm - r_mm);
      return shape.cylinder(name, {signs[k][0] * (a_mm - r_mm), y, 0.0}, r_mm, inward);
    }
    const Vec3 outs[] = {Vec3::UnitY(), -Vec3::UnitX(), -Vec3::UnitY(), Vec3::UnitX()};
    const Vec3& out = outs[k];
    return shape.plane(name, (k % 2 == 0 ? b_mm : a_mm) * out, inward ? Vec3(-out) : out);
  };
  p.round_mm = std::max(a_mm, b_mm);
  return p;
}

inline DrawnPart finish_profile(Random& random, GeneratedPart part, bool together) {
  DrawnPart drawn;
  BandInput input;
  Interval of_sides;
  for (const Feature& feature : part.features) {
    const double a = uniform(random, -0.03, 0.03), b = uniform(random, -0.03, 0.03);
    Interval offset{std::min(a, b), std::max(a, b)};
    const bool is_side = feature.name.rfind("corner", 0) == 0 || feature.name.rfind("side", 0) == 0;
    if (together && is_side) {
      if (of_sides.lo == 0.0) of_sides = offset;
      offset = of_sides;
    }
    drawn.offsets[feature.name] = offset;
    input.of_feature.push_back({offset, "drawn"});
  }
  drawn.solid = std::make_shared<const Solid>(std::move(part.mesh));
  input.solid = drawn.solid.get();
  input.features = part.features;
  drawn.band = build_band(input);
  return drawn;
}

/// A prism over the profile; or a plate with a hole of it.
inline DrawnPart profile_part(Random& random, const DrawnProfile& profile, bool inward) {
  Shape shape;
  std::map<std::string, int> faces;
  for (const std::string& name : profile.side)
    if (!faces.contains(name)) faces[name] = profile.face(shape, name, inward);
  const double top = uniform(random, 8.0, 25.0), a = profile.round_mm + 6.0;
  const Ring lower = shape.ring(profile.loop, 0.0), upper = shape.ring(profile.loop, top);
  const Ring &from = inward ? upper : lower, &to = inward ? lower : upper;
  for (std::size_t i = 0; i < profile.loop.size(); ++i)
    shape.facet(from, to, i, faces[profile.side[i]]);
  const int bottom = shape.plane("bottom", Vec3::Zero(), -Vec3::UnitZ());
  const int ceiling = shape.plane("top", {0, 0, top}, Vec3::UnitZ());
  if (inward) {
    const Loop outline = rectangle({-a, -a}, {a, a});
    const char* names[] = {"front", "right", "back", "left"};
    const Vec3 out[] = {-Vec3::UnitY(), Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitX()};
    const Ring first = shape.ring(outline, 0.0), last = shape.ring(outline, top);
    for (std::size_t i = 0; i < 4; ++i)
      shape.facet(first, last, i, shape.plane(names[i], a * out[i], out[i]));
    shape.cap(first, {lower}, false, bottom);
    shape.cap(last, {upper}, true, ceiling);
  } else {
    shape.cap(lower, {}, false, bottom);
    shape.cap(upper, {}, true, ceiling);
  }
  auto made = std::move(shape).finish();
  DrawnPart part = finish_profile(random, *std::move(made), profile.together);
  part.round_mm = profile.round_mm;
  part.length_mm = top;
  part.depth = [=](const Vec3& x, const OffsetOf& o) {
    if (!inward)
      return std::min({profile.below(x, o), x.z() + o("bottom"), top + o("top") - x.z()});
    const OffsetOf inside = [&](const std::string& name) { return -o(name); };
    return std::min(box_depth(x, {-a, -a, 0.0}, {a, a, top}, o), -profile.below(x, inside));
  };
  part.what = inward ? "profiled plate" : "profiled shaft";
  return part;
}

}  // namespace mortise::cover_parts
