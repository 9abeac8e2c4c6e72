#pragma once
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

#include "common/base/result.h"

namespace mortise {

/// The bytes of a file, and of a larger one the first `most_bytes`: who has a bound asks for one
/// more. A folder fails, and so does a pipe or a device, which may have no end.
Result<std::string> file_text(const std::filesystem::path& file,
                              std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

}  // namespace mortise
