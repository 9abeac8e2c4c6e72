#pragma once
#include <memory>
#include <optional>
#include <string>

#include "common/io/log/session_log.h"
#include "common/io/log/session_log_read.h"
#include "common/io/scenario/scene_load.h"
#include "server/options.h"

namespace mortise {

/// What a session begins with: a scenario, or the log of an earlier session.
struct SessionStart {
  std::string source;  ///< the file it came from
  std::string scenario_name, scenario_yaml;
  LoadedScene scene;
  std::optional<SessionLog> log;  ///< to be played again before the session goes on
  LogChain log_chain;             ///< place of that log, and
  std::string log_name;           ///< its file name, and
  std::string last_seal;          ///< what it was sealed with last; empty: it has no seals
  std::int64_t led_until_ns = 0;  ///< wall clock of the last tick of that log; 0: no tick
};

/// Reads the files that the options name and prints every finding. If the folder to restore from
/// has no log of the session, the scenario begins anew.
Result<SessionStart> read_start(const ServerOptions& options);

/// The new log. With `begin` it continues the log of the start from that state. A log is never
/// overwritten.
struct NewLog {
  std::unique_ptr<SessionLogWriter> writer;  ///< null: none is written
  std::string file;                          ///< empty: none is written
};
Result<NewLog> create_log(const ServerOptions& options, const SessionStart& start,
                          std::optional<LogBegin> begin);

/// `yaml` with the top-level `key` set to `value`: its line replaced, or appended. So a log holds
/// the scenario as it was really played.
std::string with_top_level(const std::string& yaml, const std::string& key,
                           const std::string& value);

}  // namespace mortise
