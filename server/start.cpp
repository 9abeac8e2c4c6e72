#include "server/start.h"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <sstream>

#include "common/io/log/log_file.h"
#include "common/io/log/replay.h"
#include "common/io/progress_log.h"
#include "common/io/scenario/assembly_parts.h"
#include "common/io/usage.h"
#include "idl/identity.h"
#include "server/restore.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

// A log that tells more, the year 2116, tells nonsense; nothing is to overflow of it.
constexpr std::int64_t kLatest_ns = std::int64_t{1} << 62;

/// Says every finding; fails when the scenario cannot be played.
Status say_findings(const std::vector<Finding>& findings, bool usable, const std::string& file) {
  std::size_t errors = 0;
  for (const Finding& finding : findings) {
    if (finding.is_error) {
      ++errors;
      log_error("{}", finding.text);
    } else {
      log_warning("{}", finding.text);
    }
  }
  if (usable) return ok();
  return fail(Code::kInvalidInput, fmt::format("{}: {} error(s), not played", file, errors));
}

Result<SessionStart> read_from_scenario(const ServerOptions& options) {
  Result<std::string> text = scenario_text(options.scenario);
  if (!text) return text.error();
  SessionStart start;
  start.source = options.scenario;
  start.scenario_name = fs::path(options.scenario).filename().string();
  start.scenario_yaml = std::move(text).value();
  if (!options.policy.empty()) {
    start.scenario_yaml = with_top_level(start.scenario_yaml, "policy", options.policy);
  }
  if (options.rate_hz > 0.0) {
    start.scenario_yaml =
        with_top_level(start.scenario_yaml, "tick_rate_hz", fmt::format("{}", options.rate_hz));
  }
  if (options.threads > 1) {  // so that a replay has the work of these ticks, on any machine
    start.scenario_yaml =
        with_top_level(start.scenario_yaml, "threads", fmt::format("{}", options.threads));
  }
  auto reading = read_scenario_text(start.scenario_yaml, options.scenario);
  if (!reading) return reading.error();
  add_assembly(*reading);
  if (const auto still = nothing_moves(reading->scenario); still && reading->usable())
    reading->findings.push_back(*still);
  if (Status status = say_findings(reading->findings, reading->usable(), options.scenario);
      !status) {
    return status.error();
  }
  if (Status kept = none_is_written(files_of(reading->scenario)); !kept) return kept.error();
  auto scene = load_scene(reading->scenario, default_meshes());
  if (!scene) return scene.error();
  if (Status status = say_findings(scene->findings, scene->usable(), options.scenario); !status) {
    return status.error();
  }
  start.scene = std::move(*scene);
  return start;
}

// The state that the newest checkpoint tells, or the log's beginning: ticks after it are still to
// be played.
Result<SessionStart> read_from_log(const fs::path& file) {
  if (Status kept = none_is_written({file}); !kept) return kept.error();
  auto log = read_session_log(file, {.keep_checkpoints = 2});
  // A log that cannot be read is bad input, whatever the reason.
  if (!log) return fail(Code::kInvalidInput, log.error().text);
  for (const std::string& note : log->notes) log_warning("{}: {}", file.string(), note);
  auto at = scene_at_last_checkpoint(*log);
  if (!at) return fail(at.error().code, file.string() + ": " + at.error().text);
  for (const std::string& note : at->notes) log_warning("{}: {}", file.string(), note);
  SessionStart start;
  start.source = file.string();
  start.scenario_name = log->scenario_name;
  start.scenario_yaml = log->scenario_yaml;
  start.scene = std::move(at->scene);
  // Notes of the meshes, as when the session began.
  (void)say_findings(start.scene.findings, true, start.source);
  start.log_chain = log->chain;
  start.log_name = file.filename().string();
  start.last_seal = log->last_seal;
  start.led_until_ns = std::min(last_time_ns(*log), kLatest_ns);
  start.log = std::move(*log);
  return start;
}

constexpr const char* kLogExtension = ".mcap";

// Later than the log that it goes on from, also by its name: so the last one is found.
std::string default_log_file(const fs::path& folder, const std::string& session,
                             const std::optional<LogBegin>& begin) {
  const std::time_t before = begin ? begin->time_ns / 1'000'000'000 : 0;
  const std::time_t now = std::max(std::time(nullptr), before);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char stamp[32];
  std::strftime(stamp, sizeof stamp, "%Y%m%d-%H%M%S", &utc);
  const std::string stem = session + "-" + stamp;
  fs::path file = folder / (stem + kLogExtension);
  // Two starts within a second: names must differ, and sort in the order of the starts.
  for (int again = 1; fs::exists(file) || LogFile::is_begun(file); ++again) {
    file = folder / fmt::format("{}_{}{}", stem, again, kLogExtension);
  }
  return file.string();
}

std::string log_file(const ServerOptions& options, const std::optional<LogBegin>& begin) {
  const fs::path place = options.log.empty() ? "sessions" : options.log;
  const bool is_folder =
      fs::is_directory(place) || (!fs::exists(place) && place.extension() != kLogExtension);
  return is_folder ? default_log_file(place, options.network.session, begin) : place.string();
}

}  // namespace

Result<SessionStart> read_start(const ServerOptions& options) {
  if (options.restore.empty()) return read_from_scenario(options);
  const auto logs = logs_to_restore(options.restore, options.network.session,
                                    // One that stood by before leaves a log that was begun later
                                    // and is not of the one that leads.
                                    options.standby_of.empty() ? Newest::kBegun : Newest::kWritten);
  for (std::size_t i = 0; i < logs.size(); ++i) {
    auto start = read_from_log(logs[i]);
    // A machine that went down leaves a log without its front; what was before it is still there.
    // Who stands by takes none but the log of the one that leads.
    const bool last = i + 1 == logs.size() || !options.standby_of.empty();
    if (start || last) return start;
    log_warning("{}; the log before it is taken: {}", start.error().text, logs[i + 1].string());
  }
  if (options.scenario.empty()) {
    return fail(Code::kInvalidInput,
                fmt::format("{}: no log of session '{}' in this folder; name a log file, or give a "
                            "scenario to begin with",
                            options.restore, options.network.session));
  }
  log_info("{} holds no log of session '{}': {} begins anew", options.restore,
           options.network.session, options.scenario);
  return read_from_scenario(options);
}

Result<NewLog> create_log(const ServerOptions& options, const SessionStart& start,
                          std::optional<LogBegin> begin) {
  NewLog log;
  if (options.no_log) return log;
  log.file = log_file(options, begin);
  const fs::path path(log.file);
  std::error_code error;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
  if (error) {
    return fail(Code::kRuntime, fmt::format("{}: {}; choose another place with --log, or --no-log",
                                            path.parent_path().string(), error.message()));
  }
  if (fs::exists(path)) {
    return fail(Code::kRuntime, log.file + ": exists already; a log is never overwritten");
  }
  LogHeader header =
      log_header(start.scene, options.network.session, start.scenario_name, start.scenario_yaml);
  if (begin) header.chain = {start.log_name, start.log_chain.part + 1, start.last_seal};
  header.begin = std::move(begin);
  LogOptions log_options;
  log_options.named_later = !options.standby_of.empty();
  log_options.rotate_bytes = static_cast<std::uint64_t>(options.log_rotate_mb * 1e6);
  if (!options.network.keys.empty()) {
    const KeyFiles keys(options.network.keys);
    auto signer = LogSigner::open(keys.certificate, keys.key);
    if (!signer) return signer.error();
    log_options.signer = std::move(*signer);
  }
  auto writer = SessionLogWriter::create(path, header, log_options);
  if (!writer) return writer.error();
  log.writer = std::move(*writer);
  return log;
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
