#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace mortise {

/// The outcome of recover_session_log().
struct Recovery {
  std::uint64_t ticks = 0, messages = 0, lost_chunks = 0;
  bool was_complete = false;
  std::vector<std::string> notes;  ///< what was lost, in words
};
/// Copies all that is whole into a new, closed log; holes are marked as gaps.
Result<Recovery> recover_session_log(const std::filesystem::path& damaged,
                                     const std::filesystem::path& new_file);

}  // namespace mortise
