#include "client/api/opened_parts.h"

#include <algorithm>
#include <map>
#include <string_view>

#include "client/api/part_body.h"
#include "common/io/scenario/mesh_scenario.h"

namespace mortise::api {
namespace {

std::string side_of(const std::string& part, const std::string& feature) {
  return mortise::yaml_word(feature.empty() ? part : part + "." + feature);
}

// The text that a person would write of these parts; their shapes are put in later.
std::string yaml_of(const std::vector<PlacedBody>& parts, const PairSayings& sayings) {
  std::vector<mortise::PartText> written;
  std::string names;
  for (const PlacedBody& placed : parts) {
    mortise::PartText text;
    text.spec.name = placed.name;
    text.spec.mesh.file = placed.name;
    text.spec.moving = placed.moving;
    written.push_back(std::move(text));
    names += (names.empty() ? "" : ", ") + placed.name;
  }
  // The name of a scene is short.
  constexpr std::size_t kMostName = 100;
  if (names.size() > kMostName) names = std::to_string(parts.size()) + " parts";
  std::string yaml = mortise::scenario_yaml(names, written);
  if (!sayings.fits.empty()) yaml += "fits:\n";
  for (const PairSayings::Fit& fit : sayings.fits) {
    constexpr std::string_view kPlusMinus = "±";
    const bool is_code = !fit.code.starts_with(kPlusMinus);
    yaml += "  - {between: [" + side_of(parts[fit.a].name, fit.feature_a) + ", " +
            side_of(parts[fit.b].name, fit.feature_b) + "], " +
            (is_code ? "code: " + mortise::yaml_word(fit.code)
                     : "plus_minus: " + mortise::yaml_word(fit.code.substr(kPlusMinus.size()))) +
            "}\n";
  }
  if (!sayings.exclusions.empty()) yaml += "exclusions:\n";
  for (const PairSayings::Exclusion& out : sayings.exclusions)
    yaml += "  - {between: [" + mortise::yaml_word(parts[out.a].name) + ", " +
            mortise::yaml_word(parts[out.b].name) +
            "], reason: " + mortise::yaml_word(out.reason.empty() ? "excluded" : out.reason) +
            "}\n";
  return yaml;
}

void put_in_shape(const PlacedBody& placed, mortise::Scenario::PartSpec& spec) {
  const PartBody& body = *placed.part.impl().body;
  spec.mesh = body.spec.mesh;
  spec.features = body.spec.features;
  spec.tolerance = body.spec.tolerance;
  spec.undeclared = body.spec.undeclared;
  spec.products = body.spec.products;
  spec.X_WP = placed.X_WP;
  // Of the same shape are parts of the same key only.
  if (spec.mesh.generator.empty()) spec.mesh.file = body.report.file + "#" + body.solid->hash();
  spec.at = {};
}

}  // namespace

mortise::Result<mortise::OpenedScene> open_parts(const std::vector<PlacedBody>& parts,
                                                 const PairSayings& sayings) {
  mortise::Result<mortise::ScenarioReading> reading =
      mortise::read_scenario_text(yaml_of(parts, sayings), "parts");
  if (!reading) return reading.error();
  mortise::OpenedScene opened;
  opened.findings = std::move(reading->findings);
  opened.scenario = std::move(reading->scenario);
  const auto first_error = [&]() -> mortise::Error {
    const auto error = std::find_if(opened.findings.begin(), opened.findings.end(),
                                    [](const mortise::Finding& f) { return f.is_error; });
    return mortise::fail(mortise::Code::kInvalidInput, error->text);
  };
  if (!opened.usable()) return first_error();
  // Nobody has seen the text: its lines mean nothing.
  for (auto& fit : opened.scenario.fits) fit.at = {};
  for (auto& exclusion : opened.scenario.exclusions) exclusion.at = {};
  std::map<std::string, const PlacedBody*> body_of;
  std::string files;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    put_in_shape(parts[i], opened.scenario.parts[i]);
    body_of[parts[i].name] = &parts[i];
    files += (i == 0 ? "" : ", ") + parts[i].part.impl().body->report.file;
  }
  const mortise::MeshProvider meshes =
      [&](const mortise::Scenario&,
          const mortise::Scenario::PartSpec& spec) -> mortise::Result<mortise::ImportedMesh> {
    const PartBody& body = *body_of.at(spec.name)->part.impl().body;
    return mortise::ImportedMesh{body.solid->mesh(), body.report};
  };
  mortise::Result<mortise::LoadedScene> scene = mortise::load_scene(opened.scenario, meshes);
  if (!scene) return scene.error();
  opened.scene = std::move(*scene);
  opened.findings.insert(opened.findings.end(), opened.scene.findings.begin(),
                         opened.scene.findings.end());
  opened.scenario.file = files;
  if (!opened.usable()) return first_error();
  return opened;
}

std::string unlike(const std::string& name, const std::vector<PlacedBody>& taken) {
  const auto is_taken = [&](const std::string& candidate) {
    return std::any_of(taken.begin(), taken.end(),
                       [&](const PlacedBody& placed) { return placed.name == candidate; });
  };
  std::string free = name;
  for (int i = 2; is_taken(free); ++i) free = name + "_" + std::to_string(i);
  return free;
}

}  // namespace mortise::api
