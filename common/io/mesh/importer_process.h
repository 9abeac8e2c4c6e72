#pragma once
#include <filesystem>
#include <string>

#include "common/base/result.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/mesh/raw_soup.h"

namespace mortise {

/// The program that reads meshes: $MORTISE_IMPORTER when set, else `mortise-import` beside the
/// running program.
std::filesystem::path importer_program();

/// Runs the importer on a file and returns its result. Every failure of it (crash, hang, limits,
/// garbage) becomes one line. The process has ended when this returns. `extension` is lower case,
/// with the dot.
Result<RawSoup> run_importer(const std::filesystem::path& file, const std::string& extension,
                             const ImportLimits& limits);

}  // namespace mortise
