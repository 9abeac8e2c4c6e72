#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "common/io/log/replay.h"
#include "common/io/log/session_log_read.h"
#include "common/io/scenario/saved_scenario.h"

/// A logged session as a scenario with its meshes: a folder, or the same as a .zip archive.
namespace mortise {

/// The files of a saved session: the scenario, and the meshes in a folder of their own.
inline constexpr std::string_view kSavedScenario = "scenario.yaml", kSavedMeshes = "meshes/",
                                  kSavedMesh = ".obj", kSavedPart = ".mstp";

struct SavedSession {
  SavedScenario scenario;
  std::string stopped_early;  ///< why the log was not computed to its end, or empty
};
/// Computes the log to its end, from its last checkpoint where it was read with one.
Result<SavedSession> saved_session(const SessionLog& log, const OnReplayedTick& on_tick);

/// Fails where the folder holds something.
Status is_free(const std::filesystem::path& folder);
/// The folder is new or empty.
Status write_folder(const SavedScenario& saved, const std::filesystem::path& folder);

/// The bytes of an archive with the files that write_folder() writes.
Result<std::string> zip_of(const SavedScenario& saved);

}  // namespace mortise
