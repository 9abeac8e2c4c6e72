#pragma once
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace mortise::lint {

/// Reads every source file below `root` and gives one line for each broken rule of the house: an
/// include against the arrows, a library named outside of its room, a class, function or main.cpp
/// that is too long, a document or a line of one that is too long, a comment that cites a document
/// or a section that is not there, a numerical constant without a reason, a place that
/// CONTRIBUTING.md names and that is not there, a room without README, a path of somebody's
/// machine. Folders of builds and of installed modules are left out. `known_long` names what may
/// stay too long, as the lines do: "server/: Inbox" a class of a header, "server/serve.cpp: serve"
/// a function or class of a source.
std::vector<std::string> broken_house_rules(const std::filesystem::path& root,
                                            const std::set<std::string>& known_long = {});

}  // namespace mortise::lint
