#pragma once
#include <cstdint>
#include <filesystem>

#include "common/base/result.h"
#include "common/io/scenario/yaml_document.h"

/// A saved session taken out of the archive of a stranger.
namespace mortise {

/// What is taken of an archive; more is refused.
struct SavedLimits {
  std::uint64_t files = 10'000;
  std::uint64_t bytes = std::uint64_t{4} << 30;    ///< of all files, unpacked
  std::uint64_t scenario_bytes = kMostYaml_bytes;  ///< its reader takes no more
};

/// Writes the files of such an archive to a folder, which is new or empty; nothing else is taken
/// from it, whatever it holds. Where it fails, the folder is as it was. The archive is read by a
/// process of its own in the sandbox of the importers. The calling process has one thread.
Status unpack(const std::filesystem::path& archive, const std::filesystem::path& folder,
              const SavedLimits& limits = {});

/// What that process says, from an open file to its end: it is believed in nothing. Writes the
/// files; names of any other file, twice the same one, more than the limits and an end too early
/// are refused in one line. `unpacked`: says what it reads of the archive.
Status take_unpacked(int unpacked, const std::filesystem::path& archive,
                     const std::filesystem::path& folder, const SavedLimits& limits);

/// Reads the archive and says it there. Never throws; all failures are said.
void tell_unpacked(const std::filesystem::path& archive, const SavedLimits& limits, int to);

}  // namespace mortise
