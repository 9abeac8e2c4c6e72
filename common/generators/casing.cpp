#include "common/generators/casing.h"

#include <algorithm>
#include <numbers>

#include "common/generators/shape.h"

/// The two halves of a gearbox for two parallel shafts along z: the input axis through the origin,
/// the output axis at x = distance. Both share the same outline and hole pattern.
namespace mortise {
namespace {

struct Hole {
  std::string name;
  Vec2 center;
  double radius_mm = 0.0;
};

/// What housing and cover have in common.
struct Layout {
  Loop outline, cavity;
  std::vector<Hole> seats;   ///< for bearings
  std::vector<Hole> screws;  ///< for screws and dowels
};

Layout layout_of(const Values& values) {
  const double a = values["distance_mm"];
  const Vec2 middle(0.5 * a + values["shift_mm"], 0.0);
  const Vec2 half(0.5 * values["length_mm"], 0.5 * values["width_mm"]);
  const double wall = values["wall_mm"];
  const Vec2 pattern = half - Vec2::Constant(0.5 * wall);
  Layout layout;
  layout.outline = rectangle(middle - half, middle + half);
  layout.cavity =
      rectangle(middle - half + Vec2::Constant(wall), middle + half - Vec2::Constant(wall));
  layout.seats = {{"seat_in", {0.0, 0.0}, 0.5 * values["seat_mm"]},
                  {"seat_out", {a, 0.0}, 0.5 * values["seat_mm"]}};
  const double screw = 0.5 * values["screw_hole_mm"];
  const double dowel = 0.5 * values["dowel_hole_mm"];
  layout.screws = {{"screw1", middle + Vec2(-pattern.x(), -pattern.y()), screw},
                   {"screw2", middle + Vec2(pattern.x(), -pattern.y()), screw},
                   {"screw3", middle + Vec2(pattern.x(), pattern.y()), screw},
                   {"screw4", middle + Vec2(-pattern.x(), pattern.y()), screw},
                   {"dowel1", middle + Vec2(0.0, -pattern.y()), dowel},
                   {"dowel2", middle + Vec2(0.0, pattern.y()), dowel}};
  return layout;
}

std::string objection(const Values& values) {
  const double wall = values["wall_mm"];
  const double a = values["distance_mm"];
  const double seat = 0.5 * values["seat_mm"];
  const double inside_x = 0.5 * values["length_mm"] - wall;
  const double inside_y = 0.5 * values["width_mm"] - wall;
  const double shift = values["shift_mm"];
  if (2.0 * seat >= a) return "the two seats meet; raise distance or lower seat";
  if (seat >= inside_y || 0.5 * a + seat + std::max(shift, -shift) >= inside_x)
    return "a seat reaches into the wall; raise length or width";
  if (std::max(values["screw_hole_mm"], values["dowel_hole_mm"]) >= wall)
    return "a hole is wider than the wall";
  if (values["dowel_hole_mm"] + values["screw_hole_mm"] >= values["length_mm"] - wall)
    return "dowel and screw holes meet";
  return {};
}

class Casing {
 public:
  explicit Casing(const Values& values) : values_(values), layout_(layout_of(values)) {}

  void outside(double z0, double z1) {
    const char* const names[] = {"front", "right", "back", "left"};
    const Vec3 outward[] = {-Vec3::UnitY(), Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitX()};
    wall(layout_.outline, z0, z1, names, outward);
  }
  void inside(double z0, double z1) {
    const char* const names[] = {"cavity_front", "cavity_right", "cavity_back", "cavity_left"};
    const Vec3 outward[] = {Vec3::UnitY(), -Vec3::UnitX(), -Vec3::UnitY(), Vec3::UnitX()};
    wall(layout_.cavity, z1, z0, names, outward);
  }
  void bore(const Hole& hole, double z0, double z1) {
    const int face =
        shape_.cylinder(hole.name, {hole.center.x(), hole.center.y(), 0.0}, hole.radius_mm, true);
    shape_.strip(ring(hole, z1), ring(hole, z0), face);
  }
  void flat(const std::string& name, const Ring& outline, const std::vector<Ring>& holes, double z,
            bool up) {
    const int face = shape_.plane(name, {0, 0, z}, up ? Vec3(Vec3::UnitZ()) : Vec3(-Vec3::UnitZ()));
    shape_.cap(outline, holes, up, face);
  }
  Ring ring(const Loop& loop, double z) { return shape_.ring(loop, z); }
  Ring ring(const Hole& hole, double z) {
    return shape_.ring(
        circle(hole.center, hole.radius_mm, values_.count("facets"), values_["phase_rad"]), z);
  }
  std::vector<Ring> rings(const std::vector<Hole>& holes, double z) {
    std::vector<Ring> list;
    for (const Hole& hole : holes) list.push_back(ring(hole, z));
    return list;
  }
  const Layout& layout() const { return layout_; }
  Result<GeneratedPart> finish() && { return std::move(shape_).finish(); }

 private:
  void wall(const Loop& loop, double z_from, double z_to, const char* const* names,
            const Vec3* outward) {
    const Ring from = shape_.ring(loop, z_from), to = shape_.ring(loop, z_to);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const int face = shape_.plane(names[i], {loop[i].x(), loop[i].y(), 0.0}, outward[i]);
      shape_.facet(from, to, i, face);
    }
  }

  const Values& values_;
  Layout layout_;
  Shape shape_;
};

/// A box with its bottom at z = 0, open at the top, bearing seats through the bottom, blind holes
/// from the rim.
Result<GeneratedPart> make_housing(const Values& values) {
  if (const std::string no = objection(values); !no.empty()) return impossible("housing", no);
  const double height = values["height_mm"];
  const double floor = values["floor_mm"];
  const double depth = values["hole_depth_mm"];
  if (floor >= height) return impossible("housing", "the floor is thicker than the housing");
  if (depth >= height) return impossible("housing", "the holes are deeper than the housing");
  Casing casing(values);
  const Layout& layout = casing.layout();
  casing.outside(0.0, height);
  casing.inside(floor, height);
  for (const Hole& seat : layout.seats) casing.bore(seat, 0.0, floor);
  for (const Hole& hole : layout.screws) casing.bore(hole, height - depth, height);

  casing.flat("bottom", casing.ring(layout.outline, 0.0), casing.rings(layout.seats, 0.0), 0.0,
              false);
  casing.flat("floor", casing.ring(layout.cavity, floor), casing.rings(layout.seats, floor), floor,
              true);
  for (const Hole& hole : layout.screws)
    casing.flat(hole.name + "_end", casing.ring(hole, height - depth), {}, height - depth, true);
  std::vector<Ring> openings = casing.rings(layout.screws, height);
  openings.push_back(casing.ring(layout.cavity, height));
  casing.flat("rim", casing.ring(layout.outline, height), openings, height, true);
  return std::move(casing).finish();
}

/// A plate from z = 0 to its thickness with seats and through holes.
Result<GeneratedPart> make_cover(const Values& values) {
  if (const std::string no = objection(values); !no.empty()) return impossible("cover", no);
  const double top = values["thickness_mm"];
  Casing casing(values);
  const Layout& layout = casing.layout();
  std::vector<Hole> holes = layout.seats;
  holes.insert(holes.end(), layout.screws.begin(), layout.screws.end());
  casing.outside(0.0, top);
  for (const Hole& hole : holes) casing.bore(hole, 0.0, top);
  casing.flat("bottom", casing.ring(layout.outline, 0.0), casing.rings(holes, 0.0), 0.0, false);
  casing.flat("top", casing.ring(layout.outline, top), casing.rings(holes, top), top, true);
  return std::move(casing).finish();
}

std::vector<GeneratorInfo::Parameter> casing_parameters(
    std::vector<GeneratorInfo::Parameter> more) {
  std::vector<GeneratorInfo::Parameter> list = {
      length("distance", "between the axes", 60.0),
      length("length", "outside, along x", 160.0),
      length("width", "outside, along y", 120.0),
      {"shift_mm", "of the middle along x", 10.0, -1000.0, 1000.0},
      length("wall", "thickness; holes stand in its middle", 14.0),
      length("seat", "diameter of the bearing seats", 35.0),
      length("screw_hole", "diameter", 6.6),
      length("dowel_hole", "diameter", 6.0)};
  list.insert(list.end(), more.begin(), more.end());
  list.push_back(facets_parameter());
  list.push_back(phase_parameter());
  return list;
}

}  // namespace

std::vector<Family> casing_families() {
  return {{{"housing",
            "gearbox housing, open at the top; faces seat_in, seat_out, screw1..4, dowel1..2, "
            "bottom, floor, rim, front, right, back, left, cavity_*",
            casing_parameters({length("height", "outside, along z", 41.0),
                               length("floor", "thickness of the bottom", 11.0),
                               length("hole_depth", "of screw and dowel holes", 18.0)})},
           make_housing},
          {{"cover",
            "cover of the housing, z in [0, thickness]; faces seat_in, seat_out, screw1..4, "
            "dowel1..2, bottom, top, front, right, back, left",
            casing_parameters({length("thickness", "along z", 11.0)})},
           make_cover}};
}

}  // namespace mortise
