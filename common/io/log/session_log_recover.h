#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace mortise {

/// The outcome of recover_session_log().
struct Recovery {
  /// Why nothing of the session can be played again; empty: it can, and the new log is there.
  std::string not_replayable = {};
  std::uint64_t ticks = 0, messages = 0, lost_chunks = 0;
  bool was_complete = false;
  std::vector<std::string> notes = {};  ///< what was lost, in words
  /// Of the new log, computed again: the last tick that agrees, and why it is not the last of all;
  /// empty: it is.
  std::uint64_t verified_to_tick = 0;
  std::string not_verified = {};
  bool differs = false;  ///< a tick was computed and is another one
};
/// Copies all that is whole into a new, closed log without seals; holes are marked as gaps. Then
/// reads that log and computes it again, which costs what verify() costs. Leaves no file when it
/// has no scene or no tick of a session that had some. Fails when the damaged file is no session
/// log, or the new one cannot be written.
Result<Recovery> recover_session_log(const std::filesystem::path& damaged,
                                     const std::filesystem::path& new_file);

}  // namespace mortise
