#pragma once
#include <filesystem>

#include "common/io/step/importer/step_tree.h"

namespace mortise {

/// The statements of size, distance and geometry of a file. Numbers are read from the entities of
/// the file themselves, because the document model of the library loses signs and limits, and those
/// of geometric tolerances from its text, because the library leaves out magnitudes that are
/// complex entities; faces by what the transfer made of them.
void read_pmi(const StepTree& tree, StepDocument& document);

}  // namespace mortise
