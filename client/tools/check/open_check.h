#pragma once
#include <filesystem>

#include "client/tools/check/check_command.h"
#include "common/io/scenario/open_scene.h"

namespace mortise {

/// Opens an assembly, a scenario or meshes. Of "arm.step" the statements in "arm.mortise.yaml"
/// beside it are read where that file exists. The exact solids of an assembly are kept.
Result<OpenedScene> open_check(const CheckCommand& command);

/// "arm.mortise.yaml" of "arm.step".
std::filesystem::path statements_beside(const std::filesystem::path& step);

}  // namespace mortise
