#include "common/io/scenario/open_scene.h"

#include <algorithm>

#include "common/base/length_unit.h"
#include "common/base/plain_text.h"
#include "common/io/scenario/assembly_parts.h"
#include "common/io/scenario/general_tolerance.h"
#include "common/io/scenario/mesh_scenario.h"

namespace mortise {
namespace {

Result<OpenedScene> opened_of(ScenarioReading reading) {
  OpenedScene opened;
  opened.findings = std::move(reading.findings);
  opened.scenario = std::move(reading.scenario);
  opened.exact = std::move(reading.exact);
  if (!opened.usable()) return opened;
  Result<LoadedScene> scene = load_scene(opened.scenario, default_meshes());
  if (!scene) return scene.error();
  opened.scene = std::move(scene).value();
  opened.findings.insert(opened.findings.end(), opened.scene.findings.begin(),
                         opened.scene.findings.end());
  return opened;
}

}  // namespace

bool OpenedScene::usable() const {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& finding) { return finding.is_error; });
}

namespace {

Status grant(const AssemblyWishes& wishes, ScenarioReading& reading) {
  if (!reading.scenario.assembly) return ok();
  Scenario::AssemblySpec& assembly = *reading.scenario.assembly;
  if (!wishes.general.empty()) {
    const auto letter = general_class(wishes.general);
    if (!letter)
      return fail(Code::kInvalidInput, "general tolerance '" + one_line(wishes.general) +
                                           "' is not known; write ISO 2768-f, -m, -c or -v");
    assembly.general = *letter;
  }
  assembly.bought.insert(assembly.bought.end(), wishes.bought.begin(), wishes.bought.end());
  assembly.fixed.insert(assembly.fixed.end(), wishes.fixed.begin(), wishes.fixed.end());
  return ok();
}

Result<OpenedScene> opened_with(Result<ScenarioReading> reading, const AssemblyWishes& wishes) {
  if (!reading) return reading.error();
  if (const Status granted = grant(wishes, *reading); !granted) return granted.error();
  reading->assembly = wishes.then;
  add_assembly(*reading);
  return opened_of(std::move(reading).value());
}

// Of a scene of these parts; of many parts, or with long names, of the first.
std::string name_of_all(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
  return is_name(all) ? all : parts.front() + " and " + std::to_string(parts.size() - 1) + " more";
}

}  // namespace

Result<OpenedScene> open_scene(const std::filesystem::path& file, const AssemblyWishes& wishes) {
  const Result<std::string> text = scenario_text(file);
  if (!text) return text.error();
  return opened_with(read_scenario_text(*text, file.string()), wishes);
}

std::string assembly_yaml(const std::filesystem::path& file, const AssemblyWishes& wishes) {
  const auto list = [](const char* key, const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + yaml_word(word);
    return text.empty() ? text : std::string("  ") + key + ": [" + text + "]\n";
  };
  std::string text =
      "name: " + yaml_word(part_names({file.string()}).front()) +
      "\nunits: mm\npolicy: report\nassembly:\n  file: " + yaml_word(file.filename().string()) +
      "\n";
  if (!wishes.general.empty()) text += "  general: " + yaml_word(wishes.general) + "\n";
  return text + list("fixed", wishes.fixed) + list("bought", wishes.bought);
}

Result<OpenedScene> open_assembly(const std::filesystem::path& file, const AssemblyWishes& wishes) {
  if (!is_text(file.string()))
    return fail(Code::kInvalidInput,
                one_line(file.string()) + ": the name of the file is not UTF-8; rename the file");
  // The scenario has the name of the STEP file for messages; its lines mean nothing.
  Result<ScenarioReading> reading = read_scenario_text(assembly_yaml(file, {}), file.string());
  if (reading && reading->scenario.assembly) reading->scenario.assembly->at = {};
  return opened_with(std::move(reading), wishes);
}

Result<OpenedScene> open_meshes(const std::vector<std::string>& files, const std::string& unit,
                                const std::string& fit) {
  if (files.size() < 2)
    return fail(
        Code::kInvalidInput,
        files.front() + ": one mesh meets nothing; name a second one, or a scenario (.yaml)");
  const std::vector<std::string> names = part_names(files);
  std::vector<PartText> parts(files.size());
  std::string all_files;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!is_text(files[i]))
      return fail(Code::kInvalidInput,
                  one_line(files[i]) + ": the name of the file is not UTF-8; rename the file");
    Scenario::PartSpec& spec = parts[i].spec;
    spec.name = names[i];
    spec.mesh.file = files[i];
    spec.mesh.unit_mm = length_unit_mm(unit).value_or(1.0);
    spec.moving = i > 0;
    all_files += (i == 0 ? "" : ", ") + files[i];
  }
  std::string yaml = scenario_yaml(name_of_all(names), parts);
  if (!fit.empty()) {
    const bool pair = files.size() == 2;
    yaml += "fits:\n  - {between: [" + yaml_word(pair ? names[0] : "*") + ", " +
            yaml_word(pair ? names[1] : "*") + "], code: " + yaml_word(fit) + "}\n";
  }
  Result<ScenarioReading> reading = read_scenario_text(yaml, "command line");
  if (!reading) return reading.error();
  // Nobody has seen the text: its lines mean nothing.
  for (auto& part : reading->scenario.parts) part.at = {};
  for (auto& stated : reading->scenario.fits) stated.at = {};
  Result<OpenedScene> opened = opened_of(std::move(reading).value());
  if (opened) opened->scenario.file = all_files;
  return opened;
}

}  // namespace mortise
