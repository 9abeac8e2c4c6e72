#include "common/generators/prismatic.h"

#include <algorithm>
#include <numbers>

#include "common/generators/shape.h"

/// Parts with flat sides: block, key, slotted block, plates with round holes.
namespace mortise {
namespace {

/// Wall of a polygon whose sides are flat faces of the given names, from z0 to z1, and both ends.
void extrude(Shape& shape, const Loop& loop, const std::vector<std::string>& names, double z0,
             double z1) {
  const Ring lower = shape.ring(loop, z0);
  const Ring upper = shape.ring(loop, z1);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 along = (loop[(i + 1) % loop.size()] - loop[i]).normalized();
    const int face = shape.plane(names[i], {loop[i].x(), loop[i].y(), z0},
                                 {along.y() + 0.0, -along.x() + 0.0, 0.0});
    shape.facet(lower, upper, i, face);
  }
}

void close_ends(Shape& shape, const Loop& outline, const std::vector<Loop>& holes, double z0,
                double z1) {
  const auto rings = [&](double z) {
    std::vector<Ring> list;
    for (const Loop& hole : holes) list.push_back(shape.ring(hole, z));
    return list;
  };
  const int lower = shape.plane("bottom", {0, 0, z0}, -Vec3::UnitZ());
  const int upper = shape.plane("top", {0, 0, z1}, Vec3::UnitZ());
  shape.cap(shape.ring(outline, z0), rings(z0), false, lower);
  shape.cap(shape.ring(outline, z1), rings(z1), true, upper);
}

/// x in [x0, x1] etc.; faces right (+x), left, back (+y), front, top (+z), bottom.
void add_box(Shape& shape, const Vec3& lo, const Vec3& hi) {
  const Loop outline = rectangle(lo.head<2>(), hi.head<2>());
  extrude(shape, outline, {"front", "right", "back", "left"}, lo.z(), hi.z());
  close_ends(shape, outline, {}, lo.z(), hi.z());
}

Result<GeneratedPart> make_block(const Values& values) {
  const Vec3 half = 0.5 * Vec3(values["x_mm"], values["y_mm"], values["z_mm"]);
  Shape shape;
  add_box(shape, -half, half);
  return std::move(shape).finish();
}

Result<GeneratedPart> make_key(const Values& values) {
  Shape shape;
  add_box(shape, {0.0, -0.5 * values["width_mm"], 0.0},
          {values["height_mm"], 0.5 * values["width_mm"], values["length_mm"]});
  return std::move(shape).finish();
}

Result<GeneratedPart> make_slot_block(const Values& values) {
  const double x = 0.5 * values["x_mm"], y = 0.5 * values["y_mm"], z = 0.5 * values["z_mm"];
  const double slot = 0.5 * values["slot_width_mm"];
  const double floor = y - values["slot_depth_mm"];
  if (slot >= x) return impossible("slot_block", "the slot is wider than the block");
  if (floor <= -y) return impossible("slot_block", "the slot is deeper than the block");
  const Loop outline = {{-x, -y},      {x, -y},        {x, y},     {slot, y},
                        {slot, floor}, {-slot, floor}, {-slot, y}, {-x, y}};
  Shape shape;
  extrude(shape, outline,
          {"front", "right", "back_right", "slot_right", "slot_floor", "slot_left", "back_left",
           "left"},
          -z, z);
  close_ends(shape, outline, {}, -z, z);
  return std::move(shape).finish();
}

struct Hole {
  std::string name;
  Vec2 center;
  double radius_mm;
};

/// A rectangular plate about the origin, from z = 0 to its thickness, with round through holes.
Result<GeneratedPart> make_plate(const std::string& kind, const Values& values,
                                 const std::vector<Hole>& holes) {
  const Vec2 half(0.5 * values["length_mm"], 0.5 * values["width_mm"]);
  const double top = values["thickness_mm"];
  for (const Hole& hole : holes) {
    if (((hole.center.cwiseAbs() + Vec2::Constant(hole.radius_mm)).array() >= half.array()).any())
      return impossible(kind, hole.name + " reaches beyond the plate");
    for (const Hole& other : holes)
      if (&other != &hole &&
          (other.center - hole.center).norm() <= other.radius_mm + hole.radius_mm)
        return impossible(kind, hole.name + " and " + other.name + " meet");
  }
  Shape shape;
  const Loop outline = rectangle(-half, half);
  extrude(shape, outline, {"front", "right", "back", "left"}, 0.0, top);
  std::vector<Loop> loops;
  for (const Hole& hole : holes) {
    const int face =
        shape.cylinder(hole.name, {hole.center.x(), hole.center.y(), 0.0}, hole.radius_mm, true);
    loops.push_back(
        circle(hole.center, hole.radius_mm, values.count("facets"), values["phase_rad"]));
    shape.strip(shape.ring(loops.back(), top), shape.ring(loops.back(), 0.0), face);
  }
  close_ends(shape, outline, loops, 0.0, top);
  return std::move(shape).finish();
}

Result<GeneratedPart> make_plate_with_bore(const Values& values) {
  return make_plate("plate_with_bore", values, {{"bore", {0, 0}, 0.5 * values["bore_mm"]}});
}

Result<GeneratedPart> make_dowel_plate(const Values& values) {
  const double x = 0.5 * values["pitch_mm"];
  return make_plate("dowel_plate", values,
                    {{"hole1", {-x, 0.0}, 0.5 * values["hole1_mm"]},
                     {"hole2", {x, 0.0}, 0.5 * values["hole2_mm"]}});
}

}  // namespace

std::vector<Family> prismatic_families() {
  const auto plate = [](std::vector<GeneratorInfo::Parameter> more) {
    std::vector<GeneratorInfo::Parameter> list = {length("length", "along x", 60.0),
                                                  length("width", "along y", 40.0),
                                                  length("thickness", "along z", 15.0)};
    list.insert(list.end(), more.begin(), more.end());
    list.push_back(facets_parameter());
    list.push_back(phase_parameter());
    return list;
  };
  return {
      {{"block",
        "box about the origin; faces right (+x), left, back (+y), front, top (+z), bottom",
        {length("x", "size along x", 20.0, 1e-4), length("y", "size along y", 20.0, 1e-4),
         length("z", "size along z", 20.0, 1e-4)}},
       make_block},
      {{"key",
        "parallel key, form B: x in [0, height], y about 0, z in [0, length]; faces as block",
        {length("width", "along y", 6.0), length("height", "along x", 6.0),
         length("length", "along z", 14.0)}},
       make_key},
      {{"slot_block",
        "box about the origin with a slot along z that opens towards +y; faces slot_left, "
        "slot_right, slot_floor, front, right, left, back_left, back_right, top, bottom",
        {length("x", "size along x", 40.0), length("y", "size along y", 20.0),
         length("z", "size along z", 30.0), length("slot_width", "along x", 12.0),
         length("slot_depth", "along y", 10.0)}},
       make_slot_block},
      {{"plate_with_bore",
        "plate about the origin, z in [0, thickness]; faces bore, top, bottom, front, right, "
        "back, left",
        plate({length("bore", "diameter of the bore", 20.0)})},
       make_plate_with_bore},
      {{"dowel_plate",
        "plate about the origin, z in [0, thickness], two holes on x; faces hole1, hole2, top, "
        "bottom, front, right, back, left",
        plate({length("pitch", "from hole to hole", 30.0), length("hole1", "diameter at -x", 6.0),
               length("hole2", "diameter at +x", 6.0)})},
       make_dowel_plate}};
}

}  // namespace mortise
