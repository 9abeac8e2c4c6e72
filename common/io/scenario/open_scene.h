#pragma once
#include <filesystem>
#include <string>
#include <vector>

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

/// Fails only when the file cannot be read, is a mesh or is no YAML.
Result<OpenedScene> open_scene(const std::filesystem::path& file);

/// Two or more mesh files as they lie in their own coordinates, without a scenario file: its text
/// is made here and read as a file's is. `unit`: of the numbers in the files. `fit`: a code of the
/// holes and shafts of the two, or of all whose axes meet ("H7/g6", "Ø20 H7/g6"); empty: none. The
/// first part stands, the others move.
Result<OpenedScene> open_meshes(const std::vector<std::string>& files, const std::string& unit,
                                const std::string& fit);

}  // namespace mortise
