#pragma once
#include <filesystem>

#include "common/io/scenario/scene_load.h"

namespace mortise {

/// A scenario file read and made ready in one go, with all findings of both steps. `scene` is empty
/// when the file already has errors.
struct OpenedScene {
  Scenario scenario;
  LoadedScene scene;
  std::vector<Finding> findings;
  bool usable() const;  ///< no finding is an error
};

/// Fails only when the file cannot be read or is no YAML.
Result<OpenedScene> open_scene(const std::filesystem::path& file);

}  // namespace mortise
