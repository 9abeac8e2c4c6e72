#include "common/io/scenario/open_scene.h"

#include <algorithm>

namespace mortise {

bool OpenedScene::usable() const {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& finding) { return finding.is_error; });
}

Result<OpenedScene> open_scene(const std::filesystem::path& file) {
  Result<ScenarioReading> reading = read_scenario(file);
  if (!reading) return reading.error();
  OpenedScene opened;
  opened.findings = std::move(reading->findings);
  opened.scenario = std::move(reading->scenario);
  if (!opened.usable()) return opened;
  Result<LoadedScene> scene = load_scene(opened.scenario, default_meshes());
  if (!scene) return scene.error();
  opened.scene = std::move(scene).value();
  opened.findings.insert(opened.findings.end(), opened.scene.findings.begin(),
                         opened.scene.findings.end());
  return opened;
}

}  // namespace mortise
