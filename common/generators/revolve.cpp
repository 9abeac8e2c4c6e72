#include "common/generators/revolve.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/generators/shape.h"

/// Turned parts: shafts with steps, keyseat and chamfers; dowels and screws, which are shafts with
/// other names; rings and bearings. Axis z, from z = 0 upwards.
namespace mortise {
namespace {

// Steps of a shaft: each has parameters of its own.
constexpr int kSections = 6;

struct Section {
  std::string name;  ///< of its cylinder
  double radius_mm = 0.0, length_mm = 0.0;
};

/// A slot for a key, closed at both ends, opening towards +x.
struct Keyseat {
  std::size_t section = 0;
  double width_mm = 0.0, depth_mm = 0.0, length_mm = 0.0, offset_mm = 0.0;
};

struct Turned {
  std::vector<Section> sections;
  std::optional<Keyseat> keyseat;
  double chamfer_mm = 0.0;  ///< at both ends, 45 degrees
  int facets = 32;
  double phase_rad = 0.0;
};

std::string objection(const Turned& turned) {
  if (turned.sections.empty()) return "no section has a diameter";
  const Section& first = turned.sections.front();
  const Section& last = turned.sections.back();
  const double ends = turned.sections.size() == 1 ? 2.0 : 1.0;
  if (turned.chamfer_mm >= std::min(first.radius_mm, last.radius_mm) ||
      ends * turned.chamfer_mm >= std::min(first.length_mm, last.length_mm))
    return "the chamfer is larger than the end section";
  if (!turned.keyseat) return {};
  const Keyseat& key = *turned.keyseat;
  if (key.section >= turned.sections.size()) return "the keyseat's section does not exist";
  const Section& section = turned.sections[key.section];
  if (key.width_mm >= 1.8 * section.radius_mm || key.depth_mm >= section.radius_mm)
    return "the keyseat is wider or deeper than its section";
  const double edge_mm =
      std::sqrt(section.radius_mm * section.radius_mm - 0.25 * key.width_mm * key.width_mm);
  if (section.radius_mm - key.depth_mm >= edge_mm)
    return "the keyseat is so shallow that it does not reach below the round";
  const bool ends_here = key.section == 0 || key.section + 1 == turned.sections.size();
  const double margin = ends_here ? turned.chamfer_mm : 0.0;
  if (key.offset_mm <= margin || key.offset_mm + key.length_mm >= section.length_mm - margin)
    return "the keyseat must lie inside its section";
  return {};
}

Loop scaled(Loop loop, double factor) {
  for (Vec2& p : loop) p *= factor;
  return loop;
}

/// The wall of the section that has the keyseat, from z_lower to z_upper.
void add_keyed_wall(Shape& shape, const Turned& turned, const Section& section, int seat,
                    const SlottedCircle& slotted, double z_lower, double z_start, double z_upper) {
  const Keyseat& key = *turned.keyseat;
  const double half = 0.5 * key.width_mm;
  const double floor_x = section.radius_mm - key.depth_mm;
  const double z0 = z_start + key.offset_mm;
  const double z1 = z0 + key.length_mm;
  const int right = shape.plane("key_right", {0, -half, 0}, Vec3::UnitY());
  const int left = shape.plane("key_left", {0, half, 0}, -Vec3::UnitY());
  const int floor = shape.plane("key_floor", {floor_x, 0, 0}, Vec3::UnitX());
  const int lower = shape.plane("key_lower", {0, 0, z0}, Vec3::UnitZ());
  const int upper = shape.plane("key_upper", {0, 0, z1}, -Vec3::UnitZ());

  const Loop round = unslotted(slotted);
  shape.strip(shape.ring(round, z_lower), shape.ring(round, z0), seat);
  shape.strip(shape.ring(round, z1), shape.ring(round, z_upper), seat);
  const Ring a = shape.ring(slotted.loop, z0);
  const Ring b = shape.ring(slotted.loop, z1);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::size_t in_slot = i - slotted.slot_begin;
    const bool on_round = i < slotted.slot_begin || in_slot == 3;
    shape.facet(a, b, i, on_round ? seat : in_slot == 0 ? right : in_slot == 1 ? floor : left);
  }
  Loop pocket = slotted.arc;
  pocket.push_back(slotted.loop[slotted.slot_begin + 2]);
  pocket.push_back(slotted.loop[slotted.slot_begin + 1]);
  shape.cap(shape.ring(pocket, z0), {}, true, lower);
  shape.cap(shape.ring(pocket, z1), {}, false, upper);
}

/// The 45 degree chamfer between an end ring and its section.
void add_chamfer(Shape& shape, const Turned& turned, const Section& section, const Loop& loop,
                 const Ring& end, double z_end, double z_wall, const char* name) {
  if (turned.chamfer_mm <= 0.0) return;
  const double up = z_wall > z_end ? 1.0 : -1.0;
  const double z_apex = z_wall - up * section.radius_mm;
  const int face = shape.cone(name, {0, 0, z_apex}, {0, 0, up}, std::numbers::pi / 4.0, false);
  const Ring wall = shape.ring(loop, z_wall);
  up > 0.0 ? shape.strip(end, wall, face) : shape.strip(wall, end, face);
}

Result<GeneratedPart> make_turned(const std::string& kind, const Turned& turned) {
  if (const std::string no = objection(turned); !no.empty()) return impossible(kind, no);
  Shape shape;
  double z = 0.0;
  Ring below;  // upper ring of the section below
  for (std::size_t i = 0; i < turned.sections.size(); ++i) {
    const Section& section = turned.sections[i];
    const double z_start = z;
    const double z_end = z + section.length_mm;
    const bool keyed = turned.keyseat && turned.keyseat->section == i;
    SlottedCircle slotted;
    if (keyed)
      slotted =
          slotted_circle(section.radius_mm, turned.facets, turned.phase_rad,
                         turned.keyseat->width_mm, section.radius_mm - turned.keyseat->depth_mm);
    const Loop loop = keyed ? unslotted(slotted)
                            : circle({0, 0}, section.radius_mm, turned.facets, turned.phase_rad);
    const Loop tip = scaled(loop, (section.radius_mm - turned.chamfer_mm) / section.radius_mm);

    // 1. What closes the section below: the lower end, or a shoulder.
    double z_lower = z_start;
    if (i == 0) {
      const int end = shape.plane("end_lower", {0, 0, 0}, -Vec3::UnitZ());
      const Ring ring = shape.ring(tip, z_start);
      shape.cap(ring, {}, false, end);
      z_lower += turned.chamfer_mm;
      add_chamfer(shape, turned, section, loop, ring, z_start, z_lower, "chamfer_lower");
    } else {
      const bool wider = section.radius_mm > turned.sections[i - 1].radius_mm;
      const int face = shape.plane("shoulder" + std::to_string(i), {0, 0, z_start},
                                   wider ? Vec3(-Vec3::UnitZ()) : Vec3(Vec3::UnitZ()));
      const Ring ring = shape.ring(loop, z_start);
      wider ? shape.cap(ring, {below}, false, face) : shape.cap(below, {ring}, true, face);
    }

    // 2. Its wall.
    const bool is_last = i + 1 == turned.sections.size();
    const double z_upper = is_last ? z_end - turned.chamfer_mm : z_end;
    const int seat = shape.cylinder(section.name, {0, 0, 0}, section.radius_mm, false);
    if (keyed)
      add_keyed_wall(shape, turned, section, seat, slotted, z_lower, z_start, z_upper);
    else
      shape.strip(shape.ring(loop, z_lower), shape.ring(loop, z_upper), seat);
    if (!is_last) below = shape.ring(loop, z_end);
    z = z_end;

    // 3. The upper end.
    if (is_last) {
      const int end = shape.plane("end_upper", {0, 0, z_end}, Vec3::UnitZ());
      const Ring ring = shape.ring(tip, z_end);
      shape.cap(ring, {}, true, end);
      add_chamfer(shape, turned, section, loop, ring, z_end, z_upper, "chamfer_upper");
    }
  }
  return std::move(shape).finish();
}

Result<GeneratedPart> make_shaft(const Values& values) {
  Turned turned;
  turned.facets = values.count("facets");
  turned.phase_rad = values["phase_rad"];
  turned.chamfer_mm = values["chamfer_mm"];
  for (int i = 1; i <= kSections; ++i) {
    const std::string n = std::to_string(i);
    const double diameter = values["d" + n + "_mm"];
    if (diameter <= 0.0) continue;
    if (turned.sections.size() + 1 != static_cast<std::size_t>(i))
      return impossible("shaft", "section " + n + " follows one without a diameter");
    if (i > 1 && diameter == 2.0 * turned.sections.back().radius_mm)
      return impossible("shaft", "sections " + std::to_string(i - 1) + " and " + n +
                                     " have the same diameter; make them one");
    turned.sections.push_back({"seat" + n, 0.5 * diameter, values["l" + n + "_mm"]});
  }
  if (const int section = values.count("key_section"); section > 0)
    turned.keyseat =
        Keyseat{static_cast<std::size_t>(section - 1), values["key_width_mm"],
                values["key_depth_mm"], values["key_length_mm"], values["key_offset_mm"]};
  return make_turned("shaft", turned);
}

Result<GeneratedPart> make_dowel(const Values& values) {
  Turned turned;
  turned.sections = {{"journal", 0.5 * values["diameter_mm"], values["length_mm"]}};
  turned.chamfer_mm = values["chamfer_mm"];
  turned.facets = values.count("facets");
  turned.phase_rad = values["phase_rad"];
  return make_turned("dowel", turned);
}

Result<GeneratedPart> make_screw(const Values& values) {
  if (values["head_diameter_mm"] <= values["diameter_mm"])
    return impossible("screw", "the head must be wider than the shank");
  Turned turned;
  turned.sections = {{"shank", 0.5 * values["diameter_mm"], values["length_mm"]},
                     {"head", 0.5 * values["head_diameter_mm"], values["head_height_mm"]}};
  turned.chamfer_mm = values["chamfer_mm"];
  turned.facets = values.count("facets");
  turned.phase_rad = values["phase_rad"];
  return make_turned("screw", turned);
}

Result<GeneratedPart> make_ring(const Values& values) {
  const double bore = 0.5 * values["bore_mm"];
  const double outer = 0.5 * values["outer_mm"];
  const double width = values["width_mm"];
  const double facet_angle = std::numbers::pi / values.count("facets");
  if (bore >= outer * std::cos(facet_angle))
    return impossible("ring", "the bore reaches through the facets of the outside");
  Shape shape;
  const int bore_face = shape.cylinder("bore", {0, 0, 0}, bore, true);
  const int outer_face = shape.cylinder("outer", {0, 0, 0}, outer, false);
  const int lower = shape.plane("lower", {0, 0, 0}, -Vec3::UnitZ());
  const int upper = shape.plane("upper", {0, 0, width}, Vec3::UnitZ());
  const Loop inside = circle({0, 0}, bore, values.count("facets"), values["phase_rad"]);
  const Loop outside = circle({0, 0}, outer, values.count("facets"), values["phase_rad"]);
  const Ring in0 = shape.ring(inside, 0.0), in1 = shape.ring(inside, width);
  const Ring out0 = shape.ring(outside, 0.0), out1 = shape.ring(outside, width);
  shape.strip(out0, out1, outer_face);
  shape.strip(in1, in0, bore_face);
  shape.strip(in0, out0, lower);
  shape.strip(out1, in1, upper);
  return std::move(shape).finish();
}

GeneratorInfo shaft_info() {
  GeneratorInfo info{"shaft",
                     "stepped shaft along +z from z = 0; faces seat1..seat6, shoulder1.., "
                     "end_lower, end_upper, chamfer_*, key_left, key_right, key_floor",
                     {}};
  for (int i = 1; i <= kSections; ++i) {
    const std::string n = std::to_string(i);
    info.parameters.push_back({"d" + n + "_mm", "diameter of section " + n + "; 0: none",
                               i == 1 ? 20.0 : 0.0, 0.0, 10'000.0});
    info.parameters.push_back(length("l" + n, "length of section " + n, i == 1 ? 60.0 : 20.0));
  }
  info.parameters.push_back(
      {"key_section", "section that has the keyseat; 0: none", 0, 0, kSections});
  info.parameters.push_back(length("key_width", "width of the keyseat", 6.0));
  info.parameters.push_back(length("key_depth", "depth of the keyseat below the round", 3.5));
  info.parameters.push_back(length("key_length", "length of the keyseat", 14.0));
  info.parameters.push_back(length("key_offset", "from the start of its section", 2.0));
  info.parameters.push_back(length("chamfer", "at both ends, 45 degrees; 0: none", 0.0, 0.0));
  info.parameters.push_back(facets_parameter());
  info.parameters.push_back(phase_parameter());
  return info;
}

}  // namespace

std::vector<Family> turned_families() {
  const std::vector<GeneratorInfo::Parameter> ring = {
      length("bore", "diameter of the bore", 15.0), length("outer", "diameter outside", 35.0),
      length("width", "along the axis", 11.0), facets_parameter(), phase_parameter()};
  return {
      {shaft_info(), make_shaft},
      {{"dowel",
        "cylindrical pin along +z from z = 0, chamfered at both ends; faces journal, end_lower, "
        "end_upper, chamfer_*",
        {length("diameter", "of the pin", 6.0), length("length", "with chamfers", 20.0),
         length("chamfer", "at both ends, 45 degrees", 0.5, 0.0), facets_parameter(),
         phase_parameter()}},
       make_dowel},
      {{"screw",
        "cap screw without thread, tip at z = 0, head on top; faces shank, head, shoulder1 (under "
        "the head), end_lower, end_upper, chamfer_*",
        {length("diameter", "of the shank", 6.0), length("length", "of the shank", 20.0),
         length("head_diameter", "of the head", 10.0), length("head_height", "of the head", 6.0),
         length("chamfer", "at both ends, 45 degrees", 0.5, 0.0), facets_parameter(),
         phase_parameter()}},
       make_screw},
      {{"ring", "ring along +z from z = 0; faces bore, outer, lower, upper", ring}, make_ring},
      {{"bearing", "a ball bearing as one ring, 6202 by default; faces bore, outer, lower, upper",
        ring},
       make_ring}};
}

}  // namespace mortise
