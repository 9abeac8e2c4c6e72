#pragma once
#include "client/web/step_uploads.h"

namespace mortise::web {

/// Reads a STEP file in the confined importer, as any other; see import_step(). Its faces go with
/// their meshes alone: the session recognizes them.
Result<BroughtAssembly> read_brought_step(const std::string& name,
                                          const std::vector<std::byte>& bytes);

}  // namespace mortise::web
