#include "common/io/scenario/scenario_assembly.h"

#include <cstdint>
#include <utility>

#include "common/io/scenario/general_tolerance.h"
#include "common/io/scenario/scenario_tolerance.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

constexpr double kLeastLength = 1e-9;  // of a direction

std::optional<Scenario::FaceAddress> read_face(YamlContext& context, const YAML::Node& node) {
  const YamlMap map(context, node, "face",
                    {"kind", "radius", "diameter", "inward", "axis", "point"});
  if (!map.usable()) return std::nullopt;
  Scenario::FaceAddress face;
  const std::string kind = map.text("kind").value_or("");
  for (std::uint8_t k = 1; k < kSurfaceKindCount; ++k)
    if (kind == name_of(SurfaceKind{k})) face.kind = SurfaceKind{k};
  if (face.kind == SurfaceKind::kUnknown) {
    map.error("kind: write plane, cylinder, cone, sphere or torus");
    return std::nullopt;
  }
  map.one_of({"radius", "diameter"});
  if (const auto radius = map.positive_length_mm("radius")) face.radius_mm = *radius;
  if (const auto diameter = map.positive_length_mm("diameter")) face.radius_mm = 0.5 * *diameter;
  face.inward = map.boolean("inward");
  face.point = map.position_mm("point");
  if (const auto axis = map.vector("axis")) {
    if (axis->norm() > kLeastLength)
      face.axis = axis->normalized();
    else
      map.error("axis", "must not be zero");
  }
  return face;
}

void read_statement(YamlContext& context, const YAML::Node& node,
                    Scenario::AssemblySpec& assembly) {
  const YamlMap map(context, node, "statement",
                    {"part", "face", "iso", "nominal", "width_to", "tolerance", "position"});
  if (!map.usable()) return;
  Scenario::AssemblySpec::Statement statement;
  statement.at.line = statement.says.at.line = map.line();
  if (const auto part = map.text("part"))
    statement.part = *part;
  else if (!map.has("part"))
    map.error("part is missing: the path of a part in the tree, '*' allowed");
  if (map.has("width_to"))
    map.error("width_to", "is not known here; state the width as iso of both planes");
  read_feature_statement(context, map, statement.says);
  if (map.has("face")) {
    statement.face = read_face(context, map.find("face"));
    if (!statement.face) return;
  } else if (!statement.says.iso_class.empty() || statement.says.position.zone_mm > 0.0) {
    map.error("needs face: a class or a position is of one face; only tolerance is of a part");
  }
  assembly.statements.push_back(std::move(statement));
}

}  // namespace

void read_assembly(YamlContext& context, const YAML::Node& node, Scenario& scenario) {
  Scenario::AssemblySpec assembly;
  if (node.IsScalar()) {
    assembly.file = node.Scalar();
    assembly.at.line = context.line_of(node);
    scenario.assembly = std::move(assembly);
    return;
  }
  const YamlMap map(context, node, "assembly",
                    {"file", "general", "fixed", "bought", "statements"});
  if (!map.usable()) return;
  assembly.at.line = map.line();
  if (const auto file = map.text("file"))
    assembly.file = *file;
  else if (!map.has("file"))
    map.error("file is missing: the path of the STEP file, relative to the scenario");
  if (const auto general = map.text("general")) {
    const auto known = general_class(*general);
    if (known)
      assembly.general = *known;
    else
      map.error("general", "'" + *general + "' is not known; write ISO 2768-f, -m, -c or -v");
  }
  if (map.has("fixed")) assembly.fixed = map.texts("fixed").value_or(std::vector<std::string>{});
  if (map.has("bought")) assembly.bought = map.texts("bought").value_or(std::vector<std::string>{});
  if (const YAML::Node list = map.find("statements")) {
    if (!list.IsSequence())
      map.error("statements", "expected a list, one '- ' an entry");
    else
      for (const auto& entry : list) read_statement(context, entry, assembly);
  }
  scenario.assembly = std::move(assembly);
}

}  // namespace mortise
