#pragma once
#include <span>
#include <string>
#include <vector>

#include "common/session/world/scenario.h"

/// Scenarios as text, made of meshes: for people to go on with, and for programs that are given
/// meshes alone.
namespace mortise {

/// Names for parts of these files: their stems, made legal and different from each other.
std::vector<std::string> part_names(const std::vector<std::string>& files);

/// A name of a part or file as YAML has it: quoted where it must be.
std::string yaml_word(const std::string& text);

/// One part, at most with what its spec says of name, shape, pose and `moving`. `remarks`: further
/// lines below it, indented by four.
struct PartText {
  Scenario::PartSpec spec;
  std::string remarks;
};

/// A scenario with these parts, lengths in mm. Surfaces are taken as they are recognized in the
/// meshes; nothing is said of tolerances.
std::string scenario_yaml(const std::string& name, std::span<const PartText> parts);

}  // namespace mortise
