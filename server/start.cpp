#include "server/start.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "common/io/replay.h"
#include "server/restore.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

/// Says every finding; fails when the scenario cannot be played.
Status say_findings(const std::vector<Finding>& findings, bool usable, const std::string& file) {
  std::size_t errors = 0;
  for (const Finding& finding : findings) {
    if (finding.is_error) {
      ++errors;
      spdlog::error("{}", finding.text);
    } else {
      spdlog::warn("{}", finding.text);
    }
  }
  if (usable) return ok();
  return fail(Code::kInvalidInput, fmt::format("{}: {} error(s), not played", file, errors));
}

Result<SessionStart> read_from_scenario(const ServerOptions& options) {
  std::ifstream in(options.scenario, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  if (!in || fs::is_directory(options.scenario)) {
    return fail(Code::kInvalidInput,
                options.scenario + ": cannot be read; give the path of a scenario file");
  }
  SessionStart start;
  start.source = options.scenario;
  start.scenario_name = fs::path(options.scenario).filename().string();
  start.scenario_yaml = text.str();
  if (!options.policy.empty()) {
    start.scenario_yaml = with_top_level(start.scenario_yaml, "policy", options.policy);
  }
  if (options.rate_hz > 0.0) {
    start.scenario_yaml =
        with_top_level(start.scenario_yaml, "tick_rate_hz", fmt::format("{}", options.rate_hz));
  }
  auto reading = read_scenario_text(start.scenario_yaml, options.scenario);
  if (!reading) return reading.error();
  if (Status status = say_findings(reading->findings, reading->usable(), options.scenario);
      !status) {
    return status.error();
  }
  auto scene = load_scene(reading->scenario, default_meshes());
  if (!scene) return scene.error();
  if (Status status = say_findings(scene->findings, scene->usable(), options.scenario); !status) {
    return status.error();
  }
  start.scene = std::move(*scene);
  return start;
}

Result<SessionStart> read_from_log(const fs::path& file) {
  auto log = read_session_log(file);
  // A log that cannot be read is bad input, whatever the reason.
  if (!log) return fail(Code::kInvalidInput, log.error().text);
  for (const std::string& note : log->notes) spdlog::warn("{}: {}", file.string(), note);
  auto scene = scene_of(*log);
  if (!scene) return fail(scene.error().code, file.string() + ": " + scene.error().text);
  SessionStart start;
  start.source = file.string();
  start.scenario_name = log->scenario_name;
  start.scenario_yaml = log->scenario_yaml;
  start.scene = std::move(*scene);
  start.log = std::move(*log);
  return start;
}

std::string default_log_file(const fs::path& folder, const std::string& session) {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char stamp[32];
  std::strftime(stamp, sizeof stamp, "%Y%m%d-%H%M%S", &utc);
  const std::string stem = session + "-" + stamp;
  fs::path file = folder / (stem + ".mcap");
  // Two starts within a second: names must differ, and sort in the order of the starts.
  for (int again = 1; fs::exists(file); ++again) {
    file = folder / fmt::format("{}_{}.mcap", stem, again);
  }
  return file.string();
}

std::string log_file(const ServerOptions& options) {
  if (options.log.empty()) return default_log_file("sessions", options.session);
  if (fs::is_directory(options.log)) return default_log_file(options.log, options.session);
  return options.log;
}

std::string unfinished(const std::string& file) { return file + ".begun"; }

}  // namespace

Result<SessionStart> read_start(const ServerOptions& options) {
  if (options.restore.empty()) return read_from_scenario(options);
  const auto file = log_to_restore(options.restore, options.session);
  if (file) return read_from_log(*file);
  if (options.scenario.empty()) {
    return fail(Code::kInvalidInput,
                fmt::format("{}: no log of session '{}' in this folder; name a log file, or give a "
                            "scenario to begin with",
                            options.restore, options.session));
  }
  spdlog::info("{} holds no log of session '{}': {} begins anew", options.restore, options.session,
               options.scenario);
  return read_from_scenario(options);
}

Result<NewLog> NewLog::create(const ServerOptions& options, const SessionStart& start) {
  NewLog log;
  if (options.no_log) return log;
  log.file_ = log_file(options);
  const fs::path path(log.file_);
  std::error_code error;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
  if (error) {
    return fail(Code::kRuntime, fmt::format("{}: {}; choose another place with --log, or --no-log",
                                            path.parent_path().string(), error.message()));
  }
  if (fs::exists(path)) {
    return fail(Code::kRuntime, log.file_ + ": exists already; a log is never overwritten");
  }
  fs::remove(unfinished(log.file_), error);  // of a start that was cut short

  LogHeader header;
  header.session = options.session;
  header.scenario_name = start.scenario_name;
  header.scenario_yaml = start.scenario_yaml;
  std::map<std::string, const TriangleMesh*> meshes;
  for (const Part& part : start.scene.world.parts) {
    meshes.emplace(part.solid->hash(), &part.solid->mesh());
    header.mesh_of_part.push_back(part.solid->hash());
  }
  header.meshes.assign(meshes.begin(), meshes.end());
  header.imports = start.scene.imports;
  LogOptions log_options;
  // A restore records faster than any disk writes.
  if (start.log) log_options.queue_ticks += start.log->ticks.size();
  auto writer = SessionLogWriter::create(unfinished(log.file_), header, log_options);
  if (!writer) return writer.error();
  log.writer_ = std::move(*writer);
  return log;
}

Status NewLog::publish() {
  if (!writer_) return ok();
  if (Status flushed = writer_->flush(); !flushed) return flushed;
  std::error_code error;
  fs::rename(unfinished(file_), file_, error);
  if (error) return fail(Code::kRuntime, file_ + ": cannot be written: " + error.message());
  return ok();
}

std::string with_top_level(const std::string& yaml, const std::string& key,
                           const std::string& value) {
  const std::string line = key + ": " + value;
  std::istringstream in(yaml);
  std::string result, text;
  bool found = false;
  while (std::getline(in, text)) {
    if (text.starts_with(key + ":")) {
      text = line;
      found = true;
    }
    result += text + "\n";
  }
  return found ? result : result + line + "\n";
}

}  // namespace mortise
