#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "common/evaluation/band.h"
#include "common/generators/generators.h"
#include "common/generators/shape.h"
#include "common/geometry/solid.h"

/// Random parts with round and plane faces, each with an offset band of its own, and what they are:
/// written down from their drawings, sharing nothing with the covers.
namespace mortise::cover_parts {

using Random = std::mt19937_64;

inline double uniform(Random& random, double lo, double hi) {
  return lo + (hi - lo) * (static_cast<double>(random() >> 11) * 0x1.0p-53);
}
inline int below(Random& random, int n) {
  return static_cast<int>(random() % static_cast<std::uint64_t>(n));
}

/// Offset of a face by name, in one layer.
using OffsetOf = std::function<double(const std::string&)>;

/// A part, and how deep a point is in it with given offsets: over its convex pieces the largest of
/// the least distances from the faces of one.
struct DrawnPart {
  SolidPtr solid;
  SurfaceBand band;
  std::map<std::string, Interval> offsets;
  std::function<double(const Vec3&, const OffsetOf&)> depth;
  double round_mm = 0.0;  ///< radius of a round that may fit into a bore
  Vec3 axis_point = Vec3::Zero();
  double length_mm = 0.0;  ///< along z
  std::string what;

  double depth_in(const Vec3& x, bool largest) const {
    return depth(x, [&](const std::string& name) {
      const auto found = offsets.find(name);
      if (found == offsets.end()) return 0.0;
      return largest ? found->second.hi : found->second.lo;
    });
  }
};

/// No offset is larger than most_mm.
inline DrawnPart finish(Random& random, GeneratedPart part, double widest_mm, double most_mm) {
  DrawnPart drawn;
  BandInput input;
  for (const Feature& feature : part.features) {
    const double a = uniform(random, -widest_mm, most_mm);
    const double b = uniform(random, -widest_mm, most_mm);
    drawn.offsets[feature.name] = {std::min(a, b), std::max(a, b)};
    input.of_feature.push_back({drawn.offsets[feature.name], "drawn"});
  }
  drawn.solid = std::make_shared<const Solid>(std::move(part.mesh));
  input.solid = drawn.solid.get();
  input.features = part.features;
  drawn.band = build_band(input);
  return drawn;
}
inline DrawnPart finish(Random& random, GeneratedPart part, double widest_mm) {
  return finish(random, std::move(part), widest_mm, widest_mm);
}

inline double box_depth(const Vec3& x, const Vec3& lo, const Vec3& hi, const OffsetOf& o) {
  return std::min({hi.x() + o("right") - x.x(), x.x() - lo.x() + o("left"),
                   hi.y() + o("back") - x.y(), x.y() - lo.y() + o("front"),
                   hi.z() + o("top") - x.z(), x.z() - lo.z() + o("bottom")});
}
inline double radius(const Vec3& x, double at_x = 0.0) { return std::hypot(x.x() - at_x, x.y()); }

/// A stepped shaft with chamfers at both ends and, sometimes, a keyseat.
inline DrawnPart shaft(Random& random, double fit_r_mm) {
  const int count = 1 + below(random, 4);
  std::vector<double> r, l;
  std::map<std::string, double> p;
  for (int i = 0; i < count; ++i) {
    double radius_mm = i == 0 ? fit_r_mm : fit_r_mm * uniform(random, 0.55, 1.5);
    if (i > 0 && std::fabs(radius_mm - r.back()) < 0.3) radius_mm = r.back() + 0.5;
    r.push_back(radius_mm);
    l.push_back(uniform(random, 8.0, 25.0));
    p["d" + std::to_string(i + 1) + "_mm"] = 2.0 * r.back();
    p["l" + std::to_string(i + 1) + "_mm"] = l.back();
  }
  const double ch = below(random, 3) == 0 ? 0.0 : uniform(random, 0.3, 1.0);
  p["chamfer_mm"] = ch;
  p["facets"] = 12 + 4 * below(random, 12);
  const bool keyed = below(random, 3) == 0 && r[0] > 4.0;
  const double kw = 0.6 * r[0], kd = 0.35 * r[0], ko = 1.5, kl = l[0] - 3.5;
  if (keyed) {
    p["key_section"] = 1;
    p["key_width_mm"] = kw;
    p["key_depth_mm"] = kd;
    p["key_offset_mm"] = ko;
    p["key_length_mm"] = kl;
  }
  const auto made = generate("shaft", p);
  if (!made) return shaft(random, fit_r_mm);  // one of thousands cannot be made
  DrawnPart part = finish(random, *made, 0.03);
  part.round_mm = r[0];
  for (const double one : l) part.length_mm += one;
  part.depth = [=](const Vec3& x, const OffsetOf& o) {
    double most = -std::numeric_limits<double>::infinity(), z = 0.0;
    const double rho = radius(x), all = part.length_mm;
    for (int i = 0; i < count; z += l[i], ++i) {
      // A section goes on into its wider neighbours; a shoulder moves with its own face.
      double from = z, to = z + l[i];
      from -= i == 0            ? o("end_lower")
              : r[i] > r[i - 1] ? o("shoulder" + std::to_string(i))
                                : 0.5 * l[i - 1];
      to += i + 1 == count    ? o("end_upper")
            : r[i] > r[i + 1] ? o("shoulder" + std::to_string(i + 1))
                              : 0.5 * l[i + 1];
      double d =
          std::min({x.z() - from, to - x.z(), r[i] + o("seat" + std::to_string(i + 1)) - rho});
      const double half = std::numbers::sqrt2 / 2.0;
      if (ch > 0.0) {
        d = std::min(d, half * (r.front() - ch - rho + x.z()) + o("chamfer_lower"));
        d = std::min(d, half * (r.back() - ch - rho + all - x.z()) + o("chamfer_upper"));
        if (i != 0 && i + 1 != count)
          d = std::max(d, std::min({x.z() - from, to - x.z(),
                                    r[i] + o("seat" + std::to_string(i + 1)) - rho}));
      }
      most = std::max(most, d);
    }
    if (keyed) {
      const double beside =
          std::max({r[0] - kd + o("key_floor") - x.x(), -0.5 * kw + o("key_right") - x.y(),
                    x.y() - 0.5 * kw + o("key_left"), ko + o("key_lower") - x.z(),
                    x.z() - ko - kl + o("key_upper")});
      most = std::min(most, beside);
    }
    return most;
  };
  part.what = "shaft";
  return part;
}

inline DrawnPart ring(Random& random, double fit_r_mm) {
  const double outer = fit_r_mm * uniform(random, 1.4, 2.2), width = uniform(random, 5.0, 20.0);
  DrawnPart part = finish(random,
                          *generate("ring", {{"bore_mm", 2.0 * fit_r_mm},
                                             {"outer_mm", 2.0 * outer},
                                             {"width_mm", width},
                                             {"facets", 16 + 4 * below(random, 12)}}),
                          0.03);
  part.round_mm = fit_r_mm;
  part.length_mm = width;
  part.depth = [=](const Vec3& x, const OffsetOf& o) {
    return std::min({radius(x) - fit_r_mm + o("bore"), outer + o("outer") - radius(x),
                     x.z() + o("lower"), width + o("upper") - x.z()});
  };
  part.what = "ring";
  return part;
}

inline DrawnPart plate(Random& random, double fit_r_mm) {
  const Vec3 half(2.5 * fit_r_mm + 5.0, 1.5 * fit_r_mm + 3.0, 0.0);
  const double top = uniform(random, 5.0, 20.0);
  const double r2 = 0.8 * fit_r_mm;
  const double pitch = 2.4 * fit_r_mm;
  DrawnPart part = finish(random,
                          *generate("dowel_plate", {{"length_mm", 2.0 * half.x()},
                                                    {"width_mm", 2.0 * half.y()},
                                                    {"thickness_mm", top},
                                                    {"pitch_mm", pitch},
                                                    {"hole1_mm", 2.0 * fit_r_mm},
                                                    {"hole2_mm", 2.0 * r2},
                                                    {"facets", 16 + 4 * below(random, 12)}}),
                          0.03);
  part.round_mm = fit_r_mm;
  part.length_mm = top;
  part.axis_point = {-0.5 * pitch, 0.0, 0.0};
  part.depth = [=](const Vec3& x, const OffsetOf& o) {
    return std::min({box_depth(x, {-half.x(), -half.y(), 0.0}, {half.x(), half.y(), top}, o),
                     radius(x, -0.5 * pitch) - fit_r_mm + o("hole1"),
                     radius(x, 0.5 * pitch) - r2 + o("hole2")});
  };
  part.what = "plate";
  return part;
}

/// A block with a blind bore from above, countersunk.
inline DrawnPart socket(Random& random, double fit_r_mm) {
  const double a = fit_r_mm + 6.0, top = uniform(random, 15.0, 30.0);
  const double floor = uniform(random, 3.0, 8.0), sink = uniform(random, 0.4, 2.0);
  const int facets = 16 + 4 * below(random, 12);
  Shape shape;
  const Loop outline = rectangle({-a, -a}, {a, a});
  const char* names[] = {"front", "right", "back", "left"};
  const Vec3 out[] = {-Vec3::UnitY(), Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitX()};
  const Ring lower = shape.ring(outline, 0.0), upper = shape.ring(outline, top);
  for (std::size_t i = 0; i < 4; ++i)
    shape.facet(lower, upper, i, shape.plane(names[i], a * out[i], out[i]));
  const Loop wide = circle({0, 0}, fit_r_mm + sink, facets, 0.0);
  const Loop narrow = circle({0, 0}, fit_r_mm, facets, 0.0);
  const Ring rim = shape.ring(wide, top), neck = shape.ring(narrow, top - sink),
             foot = shape.ring(narrow, floor);
  shape.cap(lower, {}, false, shape.plane("bottom", Vec3::Zero(), -Vec3::UnitZ()));
  shape.cap(upper, {rim}, true, shape.plane("top", {0, 0, top}, Vec3::UnitZ()));
  shape.strip(rim, neck,
              shape.cone("sink", {0, 0, top - sink - fit_r_mm}, Vec3::UnitZ(),
                         std::numbers::pi / 4.0, true));
  shape.strip(neck, foot, shape.cylinder("bore", Vec3::Zero(), fit_r_mm, true));
  shape.cap(foot, {}, true, shape.plane("floor", {0, 0, floor}, Vec3::UnitZ()));
  DrawnPart part = finish(random, *std::move(shape).finish(), 0.03);
  part.round_mm = fit_r_mm;
  part.length_mm = top;
  part.depth = [=](const Vec3& x, const OffsetOf& o) {
    const double beside = std::min(
        radius(x) - fit_r_mm + o("bore"),
        std::numbers::sqrt2 / 2.0 * (radius(x) - fit_r_mm - (x.z() - top + sink)) + o("sink"));
    return std::min(box_depth(x, {-a, -a, 0.0}, {a, a, top}, o),
                    std::max(beside, floor + o("floor") - x.z()));
  };
  part.what = "socket";
  return part;
}

inline DrawnPart block(Random& random, double) {
  const Vec3 half(uniform(random, 3.0, 15.0), uniform(random, 3.0, 15.0),
                  uniform(random, 3.0, 15.0));
  DrawnPart part = finish(
      random,
      *generate("block",
                {{"x_mm", 2.0 * half.x()}, {"y_mm", 2.0 * half.y()}, {"z_mm", 2.0 * half.z()}}),
      0.03);
  part.length_mm = half.z();
  part.depth = [=](const Vec3& x, const OffsetOf& o) { return box_depth(x, -half, half, o); };
  part.what = "block";
  return part;
}

inline DrawnPart slot_block(Random& random, double) {
  const Vec3 half(uniform(random, 12.0, 20.0), uniform(random, 6.0, 12.0),
                  uniform(random, 5.0, 15.0));
  const double slot = uniform(random, 2.0, 8.0), floor = half.y() - uniform(random, 2.0, 9.0);
  DrawnPart part = finish(random,
                          *generate("slot_block", {{"x_mm", 2.0 * half.x()},
                                                   {"y_mm", 2.0 * half.y()},
                                                   {"z_mm", 2.0 * half.z()},
                                                   {"slot_width_mm", 2.0 * slot},
                                                   {"slot_depth_mm", half.y() - floor}}),
                          0.03);
  part.length_mm = half.z();
  part.depth = [=](const Vec3& x, const OffsetOf& o) {
    const double common = std::min({half.x() + o("right") - x.x(), x.x() + half.x() + o("left"),
                                    x.y() + half.y() + o("front"), half.z() + o("top") - x.z(),
                                    x.z() + half.z() + o("bottom")});
    const double right =
        std::min(x.x() - slot + o("slot_right"), half.y() + o("back_right") - x.y());
    const double left = std::min(-slot - x.x() + o("slot_left"), half.y() + o("back_left") - x.y());
    return std::min(common, std::max({right, left, floor + o("slot_floor") - x.y()}));
  };
  part.what = "slot_block";
  return part;
}

/// Teeth with plane flanks and tips on a round body.
inline DrawnPart spline(Random& random, double fit_r_mm) {
  struct Tooth {
    Vec3 out, aside;  // unit
  };
  const int count = 3 + below(random, 9);
  const double root_r = 0.8 * fit_r_mm, tip_u = 1.15 * fit_r_mm, top = uniform(random, 5.0, 20.0);
  const double pitch = 2.0 * std::numbers::pi / count;
  const double foot = uniform(random, 0.2, 0.3) * pitch;  // half the angle of a tooth at its foot
  const double foot_u = root_r * std::cos(foot), foot_v = root_r * std::sin(foot);
  const double tip_v = uniform(random, 0.4, 0.95) * foot_v;
  // Of a flank, in the plane of a tooth: (u, v) with v towards it.
  const Vec3 flank = Vec3(foot_v - tip_v, tip_u - foot_u, 0.0).normalized();
  Shape shape;
  std::vector<Tooth> teeth;
  Loop loop;
  std::vector<int> side;
  const int root = shape.cylinder("root", Vec3::Zero(), root_r, false);
  for (int i = 0; i < count; ++i) {
    const double a = pitch * i + 0.3;
    const Tooth tooth{{std::cos(a), std::sin(a), 0.0}, {-std::sin(a), std::cos(a), 0.0}};
    teeth.push_back(tooth);
    const auto at = [&](double u, double v) { return Vec3(u * tooth.out + v * tooth.aside); };
    const std::string n = std::to_string(i);
    const auto add = [&](const Vec3& x, int face) {
      loop.push_back(x.head<2>());
      side.push_back(face);
    };
    add(at(foot_u, -foot_v),
        shape.plane("right" + n, at(foot_u, -foot_v), at(flank.x(), -flank.y())));
    add(at(tip_u, -tip_v), shape.plane("tip" + n, at(tip_u, 0.0), tooth.out));
    add(at(tip_u, tip_v), shape.plane("left" + n, at(foot_u, foot_v), at(flank.x(), flank.y())));
    add(at(foot_u, foot_v), root);
    add({root_r * std::cos(a + 0.5 * pitch), root_r * std::sin(a + 0.5 * pitch), 0.0}, root);
  }
  const Ring lower = shape.ring(loop, 0.0), upper = shape.ring(loop, top);
  for (std::size_t i = 0; i < loop.size(); ++i) shape.facet(lower, upper, i, side[i]);
  shape.cap(lower, {}, false, shape.plane("bottom", Vec3::Zero(), -Vec3::UnitZ()));
  shape.cap(upper, {}, true, shape.plane("top", {0, 0, top}, Vec3::UnitZ()));
  DrawnPart part = finish(random, *std::move(shape).finish(), 0.03);
  part.length_mm = top;
  part.depth = [=](const Vec3& x, const OffsetOf& o) {
    double most = root_r + o("root") - radius(x);
    for (int i = 0; i < count; ++i) {
      const double u = x.dot(teeth[i].out), v = x.dot(teeth[i].aside);
      const auto below_flank = [&](double aside, const char* name) {
        return flank.x() * (foot_u - u) + flank.y() * (foot_v - aside) +
               o(name + std::to_string(i));
      };
      most = std::max(most, std::min({u, below_flank(v, "left"), below_flank(-v, "right"),
                                      tip_u + o("tip" + std::to_string(i)) - u}));
    }
    return std::min({most, x.z() + o("bottom"), top + o("top") - x.z()});
  };
  part.what = "spline";
  return part;
}

inline DrawnPart any_part(Random& random, double fit_r_mm) {
  switch (below(random, 8)) {
    case 0:
    case 1:
      return shaft(random, fit_r_mm);
    case 2:
      return ring(random, fit_r_mm);
    case 3:
      return plate(random, fit_r_mm);
    case 4:
      return socket(random, fit_r_mm);
    case 5:
      return block(random, fit_r_mm);
    case 6:
      return spline(random, fit_r_mm);
    default:
      return slot_block(random, fit_r_mm);
  }
}

}  // namespace mortise::cover_parts
