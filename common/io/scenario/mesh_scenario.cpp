#include "common/io/scenario/mesh_scenario.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "common/base/json_text.h"
#include "common/base/length_unit.h"
#include "common/base/plain_text.h"

namespace mortise {
namespace {

// Leaves room for numbers behind it below the 128 bytes of a name.
constexpr std::size_t kLongestName = 100;

std::string number(double x) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, x).ptr};
}

std::string list_of(std::initializer_list<double> numbers) {
  std::string text;
  for (const double x : numbers) text += (text.empty() ? "[" : ", ") + number(x);
  return text + "]";
}

std::string quoted(const std::string& text) { return json_text(nlohmann::json(text), -1); }

std::string legal_name(const std::string& stem) {
  std::string name = one_line(stem);
  for (char& c : name)
    if (c == '.' || c == '*') c = '_';
  name.resize(utf8_prefix(std::string_view(name).substr(0, kLongestName)));
  return is_name(name) ? name : "part";
}

std::string shape_yaml(const Scenario::MeshSource& mesh) {
  if (!mesh.generator.empty()) {
    std::string text = "generator: {kind: " + yaml_word(mesh.generator);
    for (const auto& [parameter, value] : mesh.parameters)
      text += ", " + parameter + ": " + number(value);
    return text + "}";
  }
  const std::string text = "mesh: {file: " + quoted(mesh.file) + ", unit: ";
  for (const LengthUnit& unit : kLengthUnits)
    if (mesh.unit_mm == unit.mm) return text + unit.name + "}";
  return text + "mm, scale: " + number(mesh.unit_mm) + "}";
}

std::string pose_yaml(const Pose& X) {
  std::string text = "pose: {position: " + list_of({X.p.x(), X.p.y(), X.p.z()});
  if (X.q.vec().norm() > 0.0)
    text += ", quaternion: " + list_of({X.q.w(), X.q.x(), X.q.y(), X.q.z()});
  return text + "}";
}

}  // namespace

std::vector<std::string> part_names(const std::vector<std::string>& files) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const std::string& file : files) {
    const std::string stem = legal_name(std::filesystem::path(file).stem().string());
    std::string name = stem;
    for (int i = 2; !taken.insert(name).second; ++i) name = stem + "_" + std::to_string(i);
    names.push_back(name);
  }
  return names;
}

std::string yaml_word(const std::string& text) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  const bool simple = !text.empty() && std::all_of(text.begin(), text.end(), plain);
  return simple ? text : quoted(text);
}

std::string scenario_yaml(const std::string& name, std::span<const PartText> parts) {
  std::string text =
      "name: " + yaml_word(name) +
      "\nunits: mm\ndeviation: recognized  # surfaces that the meshes show\nparts:\n";
  for (const PartText& part : parts) {
    text += "  - name: " + yaml_word(part.spec.name) + "\n    " + shape_yaml(part.spec.mesh) +
            "\n    " + pose_yaml(part.spec.X_WP) + "\n";
    if (part.spec.moving) text += "    moving: true\n";
    text += part.remarks;
  }
  return text;
}

}  // namespace mortise
