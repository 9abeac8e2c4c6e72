#pragma once
#include <memory>
#include <optional>
#include <string>

#include "common/io/scene_load.h"
#include "common/io/session_log.h"
#include "server/options.h"

namespace mortise {

/// What a session begins with: a scenario, or the log of a session of before.
struct SessionStart {
  std::string source;  ///< the file it came from
  std::string scenario_name, scenario_yaml;
  LoadedScene scene;
  std::optional<SessionLog> log;  ///< to be played again before the session goes on
};

/// Reads what the options name; says every finding. With a folder to restore from that holds no log
/// of the session, the scenario begins anew.
Result<SessionStart> read_start(const ServerOptions& options);

/// The new log. Until `publish` it lies under another name, so that a start that was cut short is
/// never taken for the newest log of the session.
class NewLog {
 public:
  static Result<NewLog> create(const ServerOptions& options, const SessionStart& start);
  SessionLogWriter* writer() const { return writer_.get(); }  ///< null: none is written
  const std::string& file() const { return file_; }           ///< empty: none is written
  Status publish();

 private:
  std::string file_;
  std::unique_ptr<SessionLogWriter> writer_;
};

/// `yaml` with the top-level `key` set to `value`: its line replaced, or appended. So a log holds
/// the scenario as it was really played.
std::string with_top_level(const std::string& yaml, const std::string& key,
                           const std::string& value);

}  // namespace mortise
