#pragma once
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/step/step_document.h"

namespace mortise {

/// Does the name end as that of a STEP file? The file is not looked at.
bool is_step_name(const std::filesystem::path& file);

/// 60 s and 2 GB; of a small file less processor, ten times what reading takes.
inline constexpr ImportLimits kStepLimits{60.0, 2ULL << 30};

/// What the importer sent of a file, as it is used and as it is kept in a log.
struct StepAssembly {
  StepDocument document;
  std::vector<std::byte> bytes;
};

/// Reads a STEP assembly in a child process with limits, since a hostile file can crash the reader:
/// $MORTISE_STEP_IMPORTER when set, else `mortise-import-step` beside the running program. Every
/// failure becomes one line. Cost: about half a second and up to 110 MB a MB of the file.
Result<StepAssembly> import_step(const std::filesystem::path& file,
                                 const ImportLimits& limits = kStepLimits);

/// The volumes that pairs of its parts have in common, by exact Boolean operations in such a child.
/// An operation that fails or takes longer than ten seconds gives a negative volume. Costs reading
/// the file again, and some hundredths of a second a pair.
Result<std::vector<StepCommon>> step_commons(const std::filesystem::path& file,
                                             std::span<const StepCommonQuery> queries,
                                             const ImportLimits& limits = kStepLimits);

}  // namespace mortise
