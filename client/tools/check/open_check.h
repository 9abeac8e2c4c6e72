#pragma once
#include <filesystem>

#include "client/tools/check/check_command.h"
#include "common/io/scenario/open_scene.h"

namespace mortise {

/// What is checked, and the STEP file of its assembly (empty: none).
struct CheckSubject {
  OpenedScene opened;
  std::filesystem::path step;
};

/// Opens an assembly, a scenario or meshes. Of "arm.step" the statements in "arm.mortise.yaml"
/// beside it are read where that file exists.
Result<CheckSubject> open_check(const CheckCommand& command);

/// "arm.mortise.yaml" of "arm.step".
std::filesystem::path statements_beside(const std::filesystem::path& step);

}  // namespace mortise
