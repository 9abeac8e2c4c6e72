#include "common/io/scenario/scenario_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <tuple>

#include "common/base/in_quotes.h"
#include "common/base/length_unit.h"
#include "common/base/plain_text.h"
#include "common/generators/generators.h"
#include "common/io/scenario/brought_part.h"
#include "common/io/scenario/scenario_tolerance.h"
#include "common/math/rotation.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
// A direction or quaternion this short was not meant as one.
constexpr double kLeastLength = 1e-9;
constexpr const char* kNoName = "name is missing: give it one, e.g. name: plate";

// 1. meshes

std::optional<double> unit_of(const YamlMap& map) {
  const auto text = map.text("unit");
  if (!text) {
    if (!map.has("unit"))
      map.error("unit is missing: mesh files do not carry one; write unit: mm (cm, m, in, um)");
    return std::nullopt;
  }
  const auto mm = length_unit_mm(*text);
  if (!mm)
    map.error("unit",
              in_quotes(*text) + " is not known" + did_you_mean(*text, length_unit_names()));
  return mm;
}

void read_mesh_file(YamlContext& context, const YAML::Node& node, Scenario::MeshSource& mesh) {
  const YamlMap map(context, node, "mesh", {"file", "unit", "scale"});
  if (!map.usable()) return;
  if (const auto file = map.text("file"))
    mesh.file = *file;
  else if (!map.has("file"))
    map.error("file is missing: the path of the mesh, relative to the scenario");
  if (const auto unit = unit_of(map)) mesh.unit_mm = *unit;
  const YAML::Node scale_node = map.find("scale");
  if (scale_node && scale_node.IsSequence()) {
    map.error("scale",
              "expected one number; to mirror the part write mirror: x (y, z) beside mesh:");
  } else if (const auto scale = map.number("scale")) {
    if (*scale >= 1.0 / kLargestNumber)
      mesh.unit_mm *= *scale;
    else
      map.error("scale",
                "must be greater than 0, from 1e-9 to 1e9; to mirror the part write "
                "mirror: x (y, z) beside mesh:");
  }
}

// The whole part, mesh and features, becomes its mirror image in a plane of its own frame.
void read_mirror(const YamlMap& map, Scenario::PartSpec& part) {
  const auto text = map.text("mirror");
  if (!text) return;
  constexpr std::string_view kAxes = "xyz";
  const std::size_t axis = text->size() == 1 ? kAxes.find((*text)[0]) : std::string_view::npos;
  if (axis == std::string_view::npos) {
    map.error("mirror", "'" + *text + "' is not known; write x, y or z");
    return;
  }
  part.mesh.mirror ^= 1U << axis;
  for (auto& feature : part.features) {
    feature.surface.point[static_cast<int>(axis)] *= -1.0;
    feature.surface.axis[static_cast<int>(axis)] *= -1.0;
  }
}

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

// The generator's name and value of what the file calls `key`: lengths in the file's unit, angles
// as x_deg; a name may be written with or without its unit.
std::optional<std::pair<std::string, double>> parameter_of(const YamlContext& context,
                                                           const GeneratorInfo& info,
                                                           const std::string& key, double value) {
  for (const auto& parameter : info.parameters) {
    const std::string& name = parameter.name;
    if (name == key + "_mm") return std::pair(name, value * context.unit_mm);
    if (name == key) return std::pair(name, value);
    if (ends_with(key, "_deg") && ends_with(name, "_rad") &&
        key.substr(0, key.size() - 4) == name.substr(0, name.size() - 4))
      return std::pair(name, value * kRadPerDeg);
  }
  return std::nullopt;
}

// How the file calls a generator's parameter.
std::string file_name_of(const std::string& parameter) {
  if (ends_with(parameter, "_mm")) return parameter.substr(0, parameter.size() - 3);
  if (ends_with(parameter, "_rad")) return parameter.substr(0, parameter.size() - 4) + "_deg";
  return parameter;
}

void read_generator(YamlContext& context, const YAML::Node& node, Scenario::MeshSource& mesh) {
  if (!node.IsMap() || !node["kind"] || !node["kind"].IsScalar()) {
    context.error(node, "generator: say its kind, e.g. generator: {kind: shaft}");
    return;
  }
  const std::string kind = node["kind"].Scalar();
  const auto& all = generators();
  const auto info = std::find_if(all.begin(), all.end(), [&](auto& g) { return g.name == kind; });
  if (info == all.end()) {
    std::vector<std::string> names;
    for (const auto& g : all) names.push_back(g.name);
    context.error(node["kind"], "generator: kind " + in_quotes(kind) + " is not known" +
                                    did_you_mean(kind, names));
    return;
  }
  mesh.generator = kind;
  for (const auto& entry : node) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
    if (key == "kind") continue;
    const auto value = yaml_number(context, entry.second, "generator " + kind + ": " + key);
    if (!value) continue;
    const auto parameter = parameter_of(context, *info, key, *value);
    if (!parameter) {
      std::vector<std::string> names;
      for (const auto& p : info->parameters) names.push_back(file_name_of(p.name));
      context.error(entry.first, "generator " + kind + ": unknown parameter " + in_quotes(key) +
                                     did_you_mean(key, names));
    } else if (!mesh.parameters.insert(*parameter).second) {
      context.error(entry.first, "generator " + kind + ": '" + key + "' stands here twice");
    }
  }
}

// 2. poses

Quat read_rotation(YamlContext& context, const YamlMap& map) {
  const std::string way = map.one_of({"rotation_deg", "quaternion", "axis_angle"});
  if (way == "rotation_deg") {
    const auto deg = map.vector(way);
    if (!deg) return Quat::Identity();
    const Vec3 rad = *deg * kRadPerDeg;  // about the fixed axes x, then y, then z
    return (rotation_exp(Vec3(0, 0, rad.z())) * rotation_exp(Vec3(0, rad.y(), 0)) *
            rotation_exp(Vec3(rad.x(), 0, 0)))
        .normalized();
  }
  if (way == "quaternion") {
    const auto q = map.numbers(way, 4);
    if (!q) return Quat::Identity();
    const Quat quat((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
    if (std::fabs(quat.norm() - 1.0) <= 1e-3) return quat.normalized();
    map.error(way, "must have length 1; the order is w, x, y, z");
  }
  if (way == "axis_angle") {
    const YamlMap turn(context, map.find(way), "axis_angle", {"axis", "angle_deg"});
    const auto axis = turn.vector("axis");
    const auto angle = turn.number("angle_deg");
    if (turn.usable() && (!turn.has("axis") || !turn.has("angle_deg")))
      turn.error("needs axis: [x, y, z] and angle_deg:");
    if (!axis || !angle) return Quat::Identity();
    if (axis->norm() > kLeastLength)
      return rotation_exp(axis->normalized() * (*angle * kRadPerDeg)).normalized();
    turn.error("axis", "must not be zero");
  }
  return Quat::Identity();
}

Pose read_pose(YamlContext& context, const YAML::Node& node) {
  Pose X_WP;
  const YamlMap map(context, node, "pose",
                    {"position", "rotation_deg", "quaternion", "axis_angle"});
  if (!map.usable()) return X_WP;
  if (const auto position = map.position_mm("position")) X_WP.p = *position;
  X_WP.q = read_rotation(context, map);
  return X_WP;
}

// 3. features

constexpr const char* kBadName = "a name is one word without '.' and '*', short and printable";

struct KindKeys {
  SurfaceKind kind;
  std::vector<std::string_view> needs;  // a '|' separates ways to say the same
};

const std::vector<KindKeys>& surface_kinds() {
  static const std::vector<KindKeys> kinds{
      {SurfaceKind::kPlane, {"point", "axis"}},
      {SurfaceKind::kCylinder, {"point", "axis", "radius|diameter"}},
      {SurfaceKind::kCone, {"point", "axis", "half_angle_deg"}},
      {SurfaceKind::kSphere, {"point", "radius|diameter"}},
      {SurfaceKind::kTorus, {"point", "axis", "radius|diameter", "tube_radius"}}};
  return kinds;
}

bool has_any(const YamlMap& map, std::string_view ways) {
  const std::size_t bar = ways.find('|');
  return map.has(ways.substr(0, bar)) ||
         (bar != std::string_view::npos && map.has(ways.substr(bar + 1)));
}

void read_surface(const YamlMap& map, Surface& surface) {
  for (const std::string_view key :
       {"point", "axis", "radius", "diameter", "tube_radius", "half_angle_deg", "inward"})
    if (!map.has("kind") && map.has(key))
      map.error(key,
                "needs kind: beside it; without kind the generator's own or a recognized surface "
                "is meant");
  const auto kind = map.text("kind");
  if (!kind) return;
  const auto& kinds = surface_kinds();
  const auto found =
      std::find_if(kinds.begin(), kinds.end(), [&](auto& k) { return *kind == name_of(k.kind); });
  if (found == kinds.end()) {
    map.error("kind", "'" + *kind + "' is not known; write plane, cylinder, cone, sphere or torus");
    return;
  }
  for (const std::string_view need : found->needs)
    if (!has_any(map, need)) map.error("kind", *kind + " needs " + std::string(need) + ":");
  surface.kind = found->kind;
  if (const auto point = map.position_mm("point")) surface.point = *point;
  if (const auto axis = map.vector("axis")) {
    if (axis->norm() > kLeastLength)
      surface.axis = axis->normalized();
    else
      map.error("axis", "must not be zero");
  }
  map.one_of({"radius", "diameter"});
  if (const auto radius = map.positive_length_mm("radius")) surface.radius_mm = *radius;
  if (const auto diameter = map.positive_length_mm("diameter")) surface.radius_mm = 0.5 * *diameter;
  if (const auto tube = map.positive_length_mm("tube_radius")) surface.tube_radius_mm = *tube;
  if (const auto angle = map.number("half_angle_deg")) {
    if (*angle > 0.0 && *angle < 90.0)
      surface.half_angle_rad = *angle * kRadPerDeg;
    else
      map.error("half_angle_deg", "must lie between 0 and 90");
  }
  if (const auto inward = map.boolean("inward")) surface.inward = *inward;
}

void read_feature(YamlContext& context, const std::string& name, const YAML::Node& node,
                  Scenario::PartSpec& part) {
  const YamlMap map(context, node, "feature " + name,
                    {"kind", "point", "axis", "radius", "diameter", "tube_radius", "half_angle_deg",
                     "inward", "along", "iso", "nominal", "width_to", "tolerance", "position"});
  if (!map.usable()) return;
  Scenario::FeatureSpec feature;
  feature.name = name;
  feature.at.line = map.line();
  read_surface(map, feature.surface);
  // A generator and the file of a brought part name their faces themselves.
  if (!map.has("kind") && part.mesh.generator.empty() &&
      !part.mesh.file.ends_with(kBroughtEnding) && part.undeclared == UndeclaredSurface::kNominal)
    map.error(
        "kind is missing: write plane, cylinder, cone, sphere or torus, or deviation: recognized "
        "for the part");
  if (const auto along = map.numbers("along", 2)) {
    const Interval mm{(*along)[0] * context.unit_mm, (*along)[1] * context.unit_mm};
    if (!(mm.lo < mm.hi))
      map.error("along", "expected [from, to] with from below to");
    else if (within_range(context, map.find("along"), "feature along", {mm.lo, mm.hi, 0.0}))
      feature.along_mm = mm;
  }
  read_feature_statement(context, map, feature);
  part.features.push_back(std::move(feature));
}

void read_features(YamlContext& context, const YAML::Node& node, Scenario::PartSpec& part) {
  if (!node.IsMap()) {
    context.error(node, "features: expected names and descriptions, e.g. bore: {kind: cylinder}");
    return;
  }
  std::set<std::string> names;
  for (const auto& entry : node) {
    const std::string name = entry.first.IsScalar() ? entry.first.Scalar() : "";
    if (!is_part_name(name))
      context.error(entry.first, "features: " + std::string(kBadName));
    else if (!names.insert(name).second)
      context.error(entry.first, "features: '" + name + "' stands here twice; rename one");
    else
      read_feature(context, name, entry.second, part);
  }
}

// 4. the part, its instances and repeats

// Each part comes in through here.
void add_part(YamlContext& context, const YAML::Node& at, Scenario::PartSpec part,
              Scenario& scenario) {
  if (within_range(context, at, "part " + part.name + ": its place", part.X_WP.p))
    scenario.parts.push_back(std::move(part));
}

void read_instances(YamlContext& context, const YAML::Node& list, const Scenario::PartSpec& part,
                    Scenario& scenario) {
  if (!list.IsSequence() || list.size() == 0) {
    context.error(list, "instances: expected a list of {name, pose, moving}");
    return;
  }
  for (const auto& node : list) {
    if (scenario.parts.size() > kMaxParts) return;
    const YamlMap map(context, node, "instance", {"name", "pose", "moving", "mirror"});
    if (!map.usable()) continue;
    Scenario::PartSpec copy = part;
    read_mirror(map, copy);
    copy.at.line = map.line();
    const auto name = map.text("name");
    if (!map.has("name")) map.error(kNoName);
    if (name && !is_part_name(*name)) map.error("name", kBadName);
    copy.name = name.value_or("");
    if (const YAML::Node pose = map.find("pose")) copy.X_WP = read_pose(context, pose);
    if (const auto moving = map.boolean("moving")) copy.moving = *moving;
    add_part(context, node, std::move(copy), scenario);
  }
}

// {count: 5, step: [20, 0, 0]} or {count: [5, 4, 1], step: [20, 20, 0]}: a row or a grid of copies,
// named pin_1, pin_2, ...
void read_repeat(YamlContext& context, const YAML::Node& node, const Scenario::PartSpec& part,
                 Scenario& scenario) {
  const YamlMap map(context, node, "repeat", {"count", "step"});
  if (!map.usable()) return;
  const YAML::Node count_node = map.find("count");
  const auto step = map.vector("step");
  if (!count_node || !map.has("step")) map.error("needs count: and step: [x, y, z]");
  if (!count_node || !step) return;
  std::array<double, 3> count{1.0, 1.0, 1.0};
  const bool row = count_node.IsScalar();
  if (row) {
    if (const auto n = map.number("count")) count[0] = *n;
  } else if (const auto n = map.numbers("count", 3)) {
    std::copy(n->begin(), n->end(), count.begin());
  } else {
    return;
  }
  for (const double n : count)
    if (n < 1.0 || n != std::floor(n) || count[0] * count[1] * count[2] > kMaxParts) {
      map.error("count", "must be whole numbers, at most " + std::to_string(kMaxParts) + " copies");
      return;
    }
  int number = 0;
  for (int k = 0; k < static_cast<int>(count[2]); ++k)
    for (int j = 0; j < static_cast<int>(count[1]); ++j)
      for (int i = 0; i < static_cast<int>(count[0]); ++i) {
        Scenario::PartSpec copy = part;
        copy.name = part.name + "_" + std::to_string(++number);
        // A row steps along the whole of `step`; a grid has one component of it for each direction.
        const Vec3 shift = row ? Vec3(*step * i) : Vec3(step->cwiseProduct(Vec3(i, j, k)));
        copy.X_WP.p += shift * context.unit_mm;
        add_part(context, node, std::move(copy), scenario);
        if (scenario.parts.size() > kMaxParts) return;
      }
}

}  // namespace

std::optional<UndeclaredSurface> read_deviation(const YamlMap& map) {
  const auto text = map.text("deviation");
  if (!text) return std::nullopt;
  if (*text == "none") return UndeclaredSurface::kNominal;
  if (*text == "recognized") return UndeclaredSurface::kRecognized;
  if (*text == "estimated") return UndeclaredSurface::kEstimated;
  map.error("deviation", "'" + *text + "' is not known; write recognized, estimated or none");
  return std::nullopt;
}

void read_part(YamlContext& context, const YAML::Node& node, Scenario& scenario) {
  const YamlMap map(context, node, "part",
                    {"name", "mesh", "generator", "pose", "moving", "mirror", "chord_error",
                     "deviation", "tolerance", "features", "instances", "repeat"});
  if (!map.usable()) return;
  Scenario::PartSpec part;
  part.at.line = map.line();
  const auto name = map.text("name");
  const bool named_by_instances = map.has("instances");
  if (!map.has("name") && !named_by_instances) map.error(kNoName);
  if (name && !is_part_name(*name)) map.error("name", kBadName);
  part.name = name.value_or("");

  const std::string source = map.one_of({"mesh", "generator"});
  if (source.empty())
    map.error("has no shape: add mesh: {file: ..., unit: mm} or generator: {kind: ...}");
  if (source == "mesh") read_mesh_file(context, map.find("mesh"), part.mesh);
  if (source == "generator") read_generator(context, map.find("generator"), part.mesh);
  if (const YAML::Node pose = map.find("pose")) part.X_WP = read_pose(context, pose);
  if (const auto moving = map.boolean("moving")) part.moving = *moving;
  if (const auto chord = map.length_mm("chord_error")) {
    if (*chord >= 0.0)
      part.chord_error_mm = *chord;
    else
      map.error("chord_error", "must not be negative");
  }
  const bool knows_surfaces = source == "generator" || part.chord_error_mm;
  part.undeclared = read_deviation(map).value_or(scenario.undeclared.value_or(
      knows_surfaces ? UndeclaredSurface::kNominal : UndeclaredSurface::kRecognized));
  if (map.has("deviation") && part.undeclared == UndeclaredSurface::kEstimated &&
      part.chord_error_mm)
    map.error("deviation", "estimated and chord_error: both speak of the rest; remove one");
  if (const YAML::Node tolerance = map.find("tolerance"))
    part.tolerance = read_tolerance(context, tolerance, "part: tolerance");
  if (const YAML::Node features = map.find("features")) read_features(context, features, part);

  read_mirror(map, part);

  const std::string many = map.one_of({"instances", "repeat"});
  if (many == "instances")
    read_instances(context, map.find("instances"), part, scenario);
  else if (many == "repeat")
    read_repeat(context, map.find("repeat"), part, scenario);
  else
    add_part(context, node, std::move(part), scenario);
}

}  // namespace mortise
