#pragma once
#include <cstdlib>
#include <filesystem>

namespace mortise::test {

/// The folder of published meshes: MORTISE_DATA, else beside the project. It may be absent; tests
/// of it then skip.
inline std::filesystem::path data_folder() {
  const char* chosen = std::getenv("MORTISE_DATA");
  return chosen != nullptr ? std::filesystem::path(chosen)
                           : std::filesystem::path(MORTISE_SOURCE_DIR) / "../shared/data";
}

}  // namespace mortise::test

/// Leaves the test as skipped when a file or folder of the published meshes is absent.
#define MORTISE_NEEDS_DATA(path)                                                     \
  if (!std::filesystem::exists(path))                                                \
  GTEST_SKIP() << "data absent: published parts; set MORTISE_DATA to their folder\n" \
               << (path) << " is not there"
