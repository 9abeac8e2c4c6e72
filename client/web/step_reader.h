#pragma once
#include "client/web/step_uploads.h"

namespace mortise::web {

/// Reads a STEP file in the confined importer, as any other; see import_step(). What it states of
/// the faces of a part, and of their tolerances, goes with the mesh; see brought_part.h.
Result<BroughtAssembly> read_brought_step(const std::string& name,
                                          const std::vector<std::byte>& bytes);

}  // namespace mortise::web
