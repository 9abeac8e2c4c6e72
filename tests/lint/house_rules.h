#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace mortise::lint {

/// Reads every source file below `root` and gives one line for each broken rule of the house: an
/// include against the arrows, a library named outside of its room, a file that is too long, a room
/// without README, a path of somebody's machine. Folders of builds and of installed modules are
/// left out.
std::vector<std::string> broken_house_rules(const std::filesystem::path& root);

}  // namespace mortise::lint
