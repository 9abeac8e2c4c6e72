#include "common/generators/gear.h"

#include <cmath>
#include <numbers>

#include "common/generators/shape.h"

/// Spur gears with involute teeth, a bore and a keyway, z in [0, width].
namespace mortise {
namespace {

constexpr double kPi = std::numbers::pi;

double involute(double angle_rad) { return std::tan(angle_rad) - angle_rad; }

Vec2 polar(double radius_mm, double angle_rad) {
  return radius_mm * Vec2(std::cos(angle_rad), std::sin(angle_rad));
}

/// The profile of ISO 53 (addendum m, dedendum 1.25 m) as numbers.
struct Teeth {
  int count = 0, flank_points = 0;
  double pitch_mm = 0.0, base_mm = 0.0, tip_mm = 0.0, root_mm = 0.0;  ///< radii
  double half_pitch_angle_rad = 0.0;  ///< half the tooth's angle on the pitch circle
  double pressure_rad = 0.0;

  double half_angle_at(double radius_mm) const {
    const double here = radius_mm > base_mm ? std::acos(base_mm / radius_mm) : 0.0;
    return half_pitch_angle_rad + involute(pressure_rad) - involute(here);
  }
};

Teeth teeth_of(const Values& values) {
  Teeth teeth;
  const double module = values["module_mm"];
  teeth.count = values.count("teeth");
  teeth.flank_points = values.count("flank_points");
  teeth.pressure_rad = values["pressure_rad"];
  teeth.pitch_mm = 0.5 * module * teeth.count;
  teeth.base_mm = teeth.pitch_mm * std::cos(teeth.pressure_rad);
  teeth.tip_mm = teeth.pitch_mm + module;
  teeth.root_mm = teeth.pitch_mm - 1.25 * module;
  teeth.half_pitch_angle_rad =
      kPi / (2.0 * teeth.count) - 0.25 * values["backlash_mm"] / teeth.pitch_mm;
  return teeth;
}

enum class Part : char { kFlank, kTip, kRoot };

struct Outline {
  Loop loop;
  std::vector<Part> side;  ///< of the side from corner i to i + 1
};

/// All teeth, counter-clockwise: up one flank, over the tip, down the other, along the root.
Outline outline_of(const Teeth& teeth, double phase_rad) {
  Outline outline;
  const auto add = [&](const Vec2& p, Part side) {
    outline.loop.push_back(p);
    outline.side.push_back(side);
  };
  const double start_mm = std::max(teeth.base_mm, teeth.root_mm);
  const bool undercut = teeth.root_mm < teeth.base_mm;  // a radial line from root to base circle
  const double pitch_rad = 2.0 * kPi / teeth.count;
  for (int t = 0; t < teeth.count; ++t) {
    const double middle = phase_rad + pitch_rad * t;
    const double foot = teeth.half_angle_at(start_mm);
    if (undercut) add(polar(teeth.root_mm, middle - foot), Part::kFlank);
    for (int k = 0; k < teeth.flank_points; ++k) {
      const double r = start_mm + (teeth.tip_mm - start_mm) * k / (teeth.flank_points - 1);
      add(polar(r, middle - teeth.half_angle_at(r)),
          k + 1 == teeth.flank_points ? Part::kTip : Part::kFlank);
    }
    add(polar(teeth.tip_mm, middle), Part::kTip);
    for (int k = teeth.flank_points; k-- > 0;) {
      const double r = start_mm + (teeth.tip_mm - start_mm) * k / (teeth.flank_points - 1);
      add(polar(r, middle + teeth.half_angle_at(r)),
          k == 0 && !undercut ? Part::kRoot : Part::kFlank);
    }
    if (undercut) add(polar(teeth.root_mm, middle + foot), Part::kRoot);
    add(polar(teeth.root_mm, middle + 0.5 * pitch_rad), Part::kRoot);
  }
  return outline;
}

/// The bore, with a keyway towards +x when one is wanted. Gives its lower and upper ring.
std::pair<Ring, Ring> add_bore(Shape& shape, const Values& values) {
  const double radius = 0.5 * values["bore_mm"];
  const double width = values["width_mm"];
  const double key = values["key_width_mm"];
  const int bore = shape.cylinder("bore", {0, 0, 0}, radius, true);
  if (key <= 0.0) {
    const Loop loop = circle({0, 0}, radius, values.count("facets"), values["bore_phase_rad"]);
    const Ring lower = shape.ring(loop, 0.0), upper = shape.ring(loop, width);
    shape.strip(upper, lower, bore);
    return {lower, upper};
  }
  const double floor_x = radius + values["key_depth_mm"];
  const SlottedCircle slotted =
      slotted_circle(radius, values.count("facets"), values["bore_phase_rad"], key, floor_x);
  const int right = shape.plane("key_right", {0, -0.5 * key, 0}, Vec3::UnitY());
  const int left = shape.plane("key_left", {0, 0.5 * key, 0}, -Vec3::UnitY());
  const int floor = shape.plane("key_floor", {floor_x, 0, 0}, -Vec3::UnitX());
  const Ring lower = shape.ring(slotted.loop, 0.0), upper = shape.ring(slotted.loop, width);
  for (std::size_t i = 0; i < lower.size(); ++i) {
    const std::size_t in_slot = i - slotted.slot_begin;
    const bool on_round = i < slotted.slot_begin || in_slot == 3;
    shape.facet(upper, lower, i,
                on_round       ? bore
                : in_slot == 0 ? right
                : in_slot == 1 ? floor
                               : left);
  }
  return {lower, upper};
}

std::string objection(const Values& values, const Teeth& teeth) {
  if (teeth.half_angle_at(teeth.tip_mm) <= 0.0) return "the teeth end in a point";
  const double start_mm = std::max(teeth.base_mm, teeth.root_mm);
  if (teeth.half_angle_at(start_mm) >= kPi / teeth.count) return "the teeth meet at their feet";
  const double bore = 0.5 * values["bore_mm"];
  const double key = values["key_width_mm"];
  if (key > 0.0 && key >= 1.8 * bore) return "the keyway is wider than the bore";
  const double hub = bore + (key > 0.0 ? std::hypot(values["key_depth_mm"], 0.5 * key) : 0.0);
  if (hub >= teeth.root_mm * std::cos(kPi / teeth.count))
    return "bore and keyway reach the root of the teeth";
  return {};
}

Result<GeneratedPart> make_gear(const Values& values) {
  const Teeth teeth = teeth_of(values);
  if (const std::string no = objection(values, teeth); !no.empty()) return impossible("gear", no);
  const double width = values["width_mm"];
  Shape shape;
  const int tip = shape.cylinder("tip", {0, 0, 0}, teeth.tip_mm, false);
  const int root = shape.cylinder("root", {0, 0, 0}, teeth.root_mm, false);
  const Outline outline = outline_of(teeth, values["phase_rad"]);
  const Ring lower = shape.ring(outline.loop, 0.0), upper = shape.ring(outline.loop, width);
  for (std::size_t i = 0; i < lower.size(); ++i)
    shape.facet(lower, upper, i,
                outline.side[i] == Part::kTip    ? tip
                : outline.side[i] == Part::kRoot ? root
                                                 : Shape::kNoFace);
  const auto [bore_lower, bore_upper] = add_bore(shape, values);
  const int bottom = shape.plane("bottom", {0, 0, 0}, -Vec3::UnitZ());
  const int top = shape.plane("top", {0, 0, width}, Vec3::UnitZ());
  shape.cap(lower, {bore_lower}, false, bottom);
  shape.cap(upper, {bore_upper}, true, top);
  return std::move(shape).finish();
}

}  // namespace

std::vector<Family> gear_families() {
  return {{{"gear",
            "spur gear with involute flanks (corners on the involute; declare a chord error), z in "
            "[0, width]; faces bore, tip, root, top, bottom, key_left, key_right, key_floor",
            {length("module", "ISO 53 profile", 2.0),
             {"teeth", "number of teeth", 20, 6, 1000},
             length("width", "along z", 16.0),
             {"pressure_rad", "pressure angle", kPi / 9.0, 0.1, 0.7},
             {"flank_points", "corners of every flank", 8, 2, 256},
             length("backlash", "by which teeth are thinner, on the pitch circle", 0.2, 0.0),
             {"phase_rad", "angle of the middle of the first tooth", 0.0, -6.3, 6.3},
             length("bore", "diameter", 20.0),
             length("key_width", "of the keyway towards +x; 0: none", 0.0, 0.0),
             length("key_depth", "of the keyway beyond the bore", 2.8),
             facets_parameter(),
             {"bore_phase_rad", "angle of the first corner of the bore", 0.0, -6.3, 6.3}}},
           make_gear}};
}

}  // namespace mortise
