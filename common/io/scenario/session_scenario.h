#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/io/scenario/open_scene.h"

namespace mortise {

/// The scenario of an assembly as a session takes it, wherever that will lie: `text` is one that
/// lies in `folder`, with the assembly's file named from there. `approvals`: of clashes that the
/// parts have where they start. Fails when it is no scenario of an assembly.
Result<std::string> session_scenario(const std::string& text, const std::filesystem::path& folder,
                                     const AssemblyWishes& wishes,
                                     const std::vector<Scenario::PairReason>& approvals);

}  // namespace mortise
