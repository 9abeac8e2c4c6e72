#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/io/log/session_log.h"
#include "common/io/scenario/play_file.h"
#include "common/io/scenario/scene_load.h"
#include "common/session/tick/tick_work.h"

namespace mortise::test {

/// A session played without server and network: the acts of a play, cut into one increment a tick.
/// The same scenario, play and seed always give the same session. A seed other than 0 lets
/// increments arrive as they do over a network from bots on a busy machine: now and then a user is
/// late by a few ticks, and what was sent meanwhile arrives in one tick.
struct PlayedSession {
  LogHeader header;  ///< its meshes live in `scene`
  LoadedScene scene;
  std::vector<TickRecord> ticks;
};

Result<PlayedSession> play_session(const std::string& scenario_name, const std::string& yaml,
                                   const Play& play, int threads = 1,
                                   const StepSwitches& switches = {},
                                   std::uint64_t arrival_seed = 0);
Result<PlayedSession> play_session(const std::filesystem::path& scenario,
                                   const std::filesystem::path& play, int threads = 1,
                                   const StepSwitches& switches = {},
                                   std::uint64_t arrival_seed = 0);

/// Writes a session to a log as the server does.
Status write_log(const PlayedSession& session, const std::filesystem::path& file);

}  // namespace mortise::test
