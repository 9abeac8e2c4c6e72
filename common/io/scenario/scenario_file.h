#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.h"
#include "common/io/step/step_import.h"
#include "common/session/world/scenario.h"

namespace mortise {

/// A finding of lint: errors make the scenario unusable, warnings do not.
struct Finding {
  bool is_error = true;
  std::string text;  ///< "file:line: what; what to do"
};

struct ScenarioReading {
  Scenario scenario;
  std::vector<Finding> findings;  ///< all of them, not only the first
  AfterReading assembly = AfterReading::kEnd;
  std::shared_ptr<ExactSolids> exact;  ///< of the assembly, where they are kept
  bool usable() const;
};

/// The text of a scenario file, at most the largest that is read and one byte more. A folder, a
/// mesh or a session log in its place is an error that says what to do.
Result<std::string> scenario_text(const std::filesystem::path& file);

/// The scenario and what it names: its meshes, its STEP file.
std::vector<std::filesystem::path> files_of(const Scenario& scenario);

/// A warning for a session, where parts are to move, and none of a scene that is only judged:
/// nothing moves.
std::optional<Finding> nothing_moves(const Scenario& scenario);

/// Strict: unknown keys, missing units, wrong types are errors with file and line. Result fails
/// only when the file cannot be read or is not YAML at all. With an assembly: read_scenario reads
/// its STEP file and has its instances among the parts, read_scenario_text leaves that to
/// add_assembly.
Result<ScenarioReading> read_scenario(const std::filesystem::path& file);
Result<ScenarioReading> read_scenario_text(std::string_view yaml, const std::string& name);

}  // namespace mortise
