#pragma once
#include <string>

#include "common/io/report_json.h"
#include "common/io/step/step_document.h"

namespace mortise {

/// What is in a STEP assembly: its tree with products, faces by how their surface is known, volume,
/// open edges; bodies that are no solids; how many tolerances it states.
std::string step_text(const std::string& file, const StepDocument& document);
Json step_json(const std::string& file, const StepDocument& document);

/// Prints them: the tree on stderr and a scenario of it on stdout, or JSON there. The exit code.
int inspect_step(const std::string& file, bool json);

}  // namespace mortise
