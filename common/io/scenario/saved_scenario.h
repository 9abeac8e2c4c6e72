#pragma once
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/session/world/world.h"

namespace mortise {

/// A session as a scenario that begins where it stands: parts and poses, fits, tolerances and
/// exclusions in force, approved clashes, policy. What its scenario said in words of parts, users
/// and times stays.
struct SavedScenario {
  std::string yaml;
  struct MeshFile {
    std::string name;  ///< below the scenario
    SolidPtr solid;
    bool with_stated = false;  ///< the bytes of Solid::mesh().stated; else an OBJ of the mesh
  };
  std::vector<MeshFile> meshes;
  std::vector<std::string> left_out;  ///< what a scenario cannot hold, one line each
};

/// A session as it began.
struct BegunScenario {
  std::string yaml;  ///< as it was played
  const Scenario& scenario;
  const std::vector<std::string>& mesh_of_part;  ///< hash, by part of the scenario
};

/// Parts of a STEP assembly become parts of their own, with what its file states of each.
Result<SavedScenario> saved_scenario(const BegunScenario& begun, const World& world);

}  // namespace mortise
