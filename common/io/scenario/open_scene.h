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
  std::shared_ptr<ExactSolids> exact;  ///< of its assembly, where that is wished
  bool usable() const;                 ///< no finding is an error
};

/// What is wished of an assembly beside what its file and a scenario say.
struct AssemblyWishes {
  std::string general;              ///< "ISO 2768-m"; empty: as the scenario says
  std::vector<std::string> bought;  ///< paths and products, see AssemblySpec
  std::vector<std::string> fixed;   ///< paths of what does not move
  AfterReading then = AfterReading::kEnd;
};

/// Fails only when the file cannot be read, is a mesh or is no YAML.
Result<OpenedScene> open_scene(const std::filesystem::path& file,
                               const AssemblyWishes& wishes = {});

/// A STEP file alone: everything may move but for what is fixed.
Result<OpenedScene> open_assembly(const std::filesystem::path& file,
                                  const AssemblyWishes& wishes = {});

/// The text of a scenario of one STEP file, which lies in the folder of the scenario.
std::string assembly_yaml(const std::filesystem::path& file, const AssemblyWishes& wishes);

/// Two or more mesh files as they lie in their own coordinates, without a scenario file: its text
/// is made here and read as a file's is. `unit`: of the numbers in the files. `fit`: a code of the
/// holes and shafts of the two, or of all whose axes meet ("H7/g6", "Ø20 H7/g6"); empty: none. The
/// first part stands, the others move.
Result<OpenedScene> open_meshes(const std::vector<std::string>& files, const std::string& unit,
                                const std::string& fit);

}  // namespace mortise
