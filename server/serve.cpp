#include "server/serve.h"

#include <spdlog/spdlog.h>

#include <atomic>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>

#include "common/io/scene_load.h"
#include "idl/dds_channel.h"
#include "server/announcer.h"
#include "server/closing.h"

namespace mortise {
namespace {

std::atomic<bool> stop_asked{false};  // lock-free: set in a signal handler

void ask_to_stop(int) { stop_asked = true; }

int say(const Error& error) {
  spdlog::error("{}", error.text);
  return exit_code_of(error.code);
}

struct LoadedScenario {
  std::string yaml;
  LoadedScene scene;
};

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

Result<LoadedScenario> load(const ServerOptions& options) {
  std::ifstream in(options.scenario, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  if (!in || std::filesystem::is_directory(options.scenario)) {
    return fail(Code::kInvalidInput,
                options.scenario + ": cannot be read; give the path of a scenario file");
  }
  std::string yaml = text.str();
  if (!options.policy.empty()) yaml = with_top_level(yaml, "policy", options.policy);
  if (options.rate_hz > 0.0) {
    yaml = with_top_level(yaml, "tick_rate_hz", fmt::format("{}", options.rate_hz));
  }
  auto reading = read_scenario_text(yaml, options.scenario);
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
  return LoadedScenario{std::move(yaml), std::move(*scene)};
}

std::string default_log_file(const std::string& session) {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char stamp[32];
  std::strftime(stamp, sizeof stamp, "%Y%m%d-%H%M%S", &utc);
  return "sessions/" + session + "-" + stamp + ".mcap";
}

Result<std::unique_ptr<SessionLogWriter>> open_log(const std::string& file,
                                                   const ServerOptions& options,
                                                   const LoadedScenario& loaded) {
  const std::filesystem::path path(file);
  std::error_code error;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), error);
  if (error) {
    return fail(Code::kRuntime, fmt::format("{}: {}; choose another place with --log, or --no-log",
                                            path.parent_path().string(), error.message()));
  }
  LogHeader header;
  header.session = options.session;
  header.scenario_name = std::filesystem::path(options.scenario).filename().string();
  header.scenario_yaml = loaded.yaml;
  std::map<std::string, const TriangleMesh*> meshes;
  for (const Part& part : loaded.scene.world.parts) {
    meshes.emplace(part.solid->hash(), &part.solid->mesh());
    header.mesh_of_part.push_back(part.solid->hash());
  }
  header.meshes.assign(meshes.begin(), meshes.end());
  header.imports = loaded.scene.imports;
  return SessionLogWriter::create(path, header);
}

int close_session(const ServerOptions& options, Closing closing, SessionLogWriter* log,
                  const TickLoop& loop) {
  int exit_code = kExitOk;
  if (log != nullptr) {
    if (Status status = log->close(); !status) exit_code = say(status.error());
    closing.log_bytes = log->bytes_written();
    closing.log_dropped_ticks = log->dropped_ticks();
  }
  if (options.json) {
    std::cout << closing_json(closing, loop).dump(2) << std::endl;
  } else {
    std::cout << closing_table(closing, loop) << std::flush;
  }
  if (!options.stats.empty()) {
    std::ofstream out(options.stats);
    out << closing_json(closing, loop).dump(2) << "\n";
    if (!out.flush()) {
      spdlog::error("{}: cannot be written", options.stats);
      exit_code = kExitRuntime;
    }
  }
  return exit_code;
}

}  // namespace

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

int serve(const ServerOptions& options) {
  auto loaded = load(options);
  if (!loaded) return say(loaded.error());
  World& world = loaded->scene.world;

  DdsOptions dds;
  dds.session = options.session;
  dds.domain = options.domain;
  dds.interface = options.interface;
  dds.discovery_port = options.port;
  auto channel = open_server_channel(dds);
  if (!channel) return say(channel.error());

  Closing closing;
  closing.session = options.session;
  closing.scenario = options.scenario;
  closing.policy = world.policy == Policy::kStop ? "stop" : "report";
  for (std::size_t i = 0; i < loaded->scene.imports.size() && i < world.parts.size(); ++i) {
    if (!loaded->scene.imports[i].closed)
      closing.parts_without_inside.push_back(world.parts[i].name);
  }
  std::unique_ptr<SessionLogWriter> log;
  if (!options.no_log) {
    closing.log_file = options.log.empty() ? default_log_file(options.session) : options.log;
    auto opened = open_log(closing.log_file, options, *loaded);
    if (!opened) return say(opened.error());
    log = std::move(*opened);
  }

  std::signal(SIGINT, ask_to_stop);
  std::signal(SIGTERM, ask_to_stop);
  SystemClock clock;
  TickLoopOptions loop_options;
  loop_options.session = options.session;
  loop_options.threads = options.threads;
  TickLoop loop(world, **channel, clock, log.get(), loop_options);
  loop.open();
  spdlog::info("session '{}' of {} on domain {}, {}: {} parts, {:g} Hz, policy {}{}",
               options.session, options.scenario, options.domain, options.interface,
               world.parts.size(), world.tick_rate_hz, closing.policy,
               log ? ", log " + closing.log_file : std::string());
  for (const std::string& part : closing.parts_without_inside) {
    spdlog::warn("'{}' has no inside (open or non-manifold): crossing is found, depth is not",
                 part);
  }

  Announcer announcer(options.live, options.quiet);
  loop.run(
      [&] {
        return stop_asked || (options.duration_s > 0.0 && loop.seconds() >= options.duration_s);
      },
      [&] { announcer.after_tick(loop); });
  announcer.finish();
  loop.close();
  closing.channel = (*channel)->counters();
  return close_session(options, std::move(closing), log.get(), loop);
}

}  // namespace mortise
