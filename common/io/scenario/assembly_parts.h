#pragma once
#include <span>

#include "common/io/scenario/scenario_file.h"
#include "common/io/step/step_document.h"

namespace mortise {

/// Reads the STEP file of the scenario's assembly in a child process and adds its instances to the
/// parts. Nothing to do where there is no assembly, or the reading is not usable.
void add_assembly(ScenarioReading& reading);

/// The same with what the importer sent before, as a log keeps it.
void add_assembly(ScenarioReading& reading, std::span<const std::byte> sent);

/// What the importer could not read of a file: it is missing among the parts, or in a wrong place.
std::vector<std::string> not_read_of(const StepDocument& document);
/// The same of the scenario's assembly; empty: it has none.
std::vector<std::string> not_read_of(const Scenario& scenario);
/// Exit code of programs where there is some of it.
inline constexpr int kExitNotWhole = 7;

/// A name of a part for a path of the tree: without '.', '*' and what cannot be seen, at most
/// kMostName_bytes (the front is cut off).
std::string part_name_of(const std::string& path);

}  // namespace mortise
