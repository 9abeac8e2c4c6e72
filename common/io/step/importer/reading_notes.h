#pragma once
#include <string>
#include <vector>

#include "common/io/step/importer/step_tree.h"

namespace mortise {

/// What of shapes and places the library passed over in a file that it read and transferred: what
/// is missing in the file, what it did not understand, and instances that came to nothing.
std::vector<std::string> reading_notes(const StepTree& tree);

}  // namespace mortise
