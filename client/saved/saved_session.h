#pragma once
#include <filesystem>
#include <string>

#include "common/io/log/replay.h"
#include "common/io/log/session_log_read.h"
#include "common/io/scenario/saved_scenario.h"

/// A logged session as a scenario with its meshes: a folder, or the same as a .zip archive.
namespace mortise {

struct SavedSession {
  SavedScenario scenario;
  std::string stopped_early;  ///< why the log was not computed to its end, or empty
};
/// Computes the log to its end, from its last checkpoint where it was read with one. Fails for a
/// session on a STEP assembly.
Result<SavedSession> saved_session(const SessionLog& log, const OnReplayedTick& on_tick);

/// The folder is new or empty.
Status write_folder(const SavedScenario& saved, const std::filesystem::path& folder);

/// The bytes of an archive with the files that write_folder() writes.
Result<std::string> zip_of(const SavedScenario& saved);

/// What is taken of an archive; more is refused.
struct SavedLimits {
  std::uint64_t files = 10'000;
  std::uint64_t bytes = std::uint64_t{4} << 30;  ///< of all files, unpacked
};
/// Writes the files of such an archive to a folder, which is new or empty; nothing else is taken
/// from it, whatever it holds. Where it fails, the folder is as it was.
Status unpack(const std::filesystem::path& archive, const std::filesystem::path& folder,
              const SavedLimits& limits = {});

}  // namespace mortise
