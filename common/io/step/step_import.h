#pragma once
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/io/mesh/confined_child.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/step/step_document.h"

namespace mortise {

/// Does the name end as that of a STEP file? The file is not looked at.
bool is_step_name(const std::filesystem::path& file);

/// 60 s and 2 GB; of a small file less processor, ten times what reading takes.
inline constexpr ImportLimits kStepLimits{60.0, 2ULL << 30};

/// The exact solids of a STEP file, in an importer that keeps what it read. Ends with its owner.
class ExactSolids {
 public:
  explicit ExactSolids(ConfinedDialogue importer) : importer_(std::move(importer)) {}

  /// The volumes that pairs of parts have in common, by exact Boolean operations, some hundredths
  /// of a second each. A negative volume: it failed, took longer than ten seconds, or its turn did
  /// not come within kCommons_s. Can be asked once.
  Result<std::vector<StepCommon>> commons(std::span<const StepCommonQuery> queries);

 private:
  ConfinedDialogue importer_;
};

/// What the importer sent of a file, as it is used and as it is kept in a log.
struct StepAssembly {
  StepDocument document;
  std::vector<std::byte> bytes;
  std::shared_ptr<ExactSolids> exact;  ///< where they were asked for
};

/// Whether the importer ends when it has said what is in the file.
enum class AfterReading : std::uint8_t { kEnd = 0, kKeepSolids };

/// Reads a STEP assembly in a child process with limits, since a hostile file can crash the reader:
/// $MORTISE_STEP_IMPORTER when set, else `mortise-import-step` beside the running program. Every
/// failure becomes one line. Cost: about half a second and up to 110 MB a MB of the file.
Result<StepAssembly> import_step(const std::filesystem::path& file,
                                 AfterReading then = AfterReading::kEnd,
                                 const ImportLimits& limits = kStepLimits);

}  // namespace mortise
