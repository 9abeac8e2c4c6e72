#include "client/bot/bot.h"

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <iostream>
#include <optional>
#include <thread>

#include "client/bot/crew.h"
#include "client/bot/load_text.h"
#include "client/bot/processes.h"
#include "common/base/json_text.h"
#include "common/io/progress_log.h"
#include "common/io/scenario/play_file.h"
#include "idl/dds_channel.h"

namespace mortise {
namespace {

using Json = nlohmann::ordered_json;

/// Joins, acts and leaves, in this process.
int run_crew(const BotOptions& options, std::optional<Play> play, ProcessReport& report) {
  auto channel = open_client_channel(options.network);
  if (!channel) {
    log_error("{}", channel.error().text);
    return exit_code_of(channel.error().code);
  }
  return Crew(options, **channel, std::move(play)).run(report);
}

/// Process k of the load: users of its own, its share of the ramp, and all end together.
int run_share(const BotOptions& options, int k, ProcessReport& report) {
  BotOptions own = options;
  const double begin_s = options.ramp_s * k / options.processes;
  for (int i = 0; i < options.users; ++i) {
    own.names.push_back(fmt::format("{}{}-{}.{}", options.observer ? "observer" : "bot",
                                    options.seed, k + 1, i + 1));
  }
  own.seed = options.seed * 1000 + static_cast<std::uint64_t>(k);
  own.first_part = options.first_part + static_cast<std::size_t>(k * options.users);
  own.ramp_s = options.ramp_s / options.processes;
  own.quiet = own.quiet || k > 0;
  if (own.duration_s > 0.0) own.duration_s = std::max(own.duration_s - begin_s, 0.1);
  std::this_thread::sleep_for(std::chrono::duration<double>(begin_s));
  return run_crew(own, std::nullopt, report);
}

Status write_junit(const std::string& file, const std::vector<LimitResult>& results,
                   double seconds) {
  if (file.empty()) return ok();
  std::ofstream out(file);
  out << junit(results, seconds);
  if (!out.flush()) return fail(Code::kRuntime, file + ": cannot be written");
  return ok();
}

/// Prints the report, holds it against the limits.
int conclude(const BotOptions& options, Json document) {
  const std::vector<LimitResult> results = check_limits(document, options.limits);
  if (!results.empty()) document["limits"] = json_of(results);
  std::cout << (options.json ? json_text(document) + "\n" : load_text(document)) << std::flush;
  if (Status written = write_junit(options.junit, results, document["seconds"].get<double>());
      !written) {
    log_error("{}", written.error().text);
    return kExitRuntime;
  }
  int exit_code = kExitOk;
  for (const LimitResult& result : results) {
    if (result.holds) continue;
    exit_code = kExitThreshold;
    if (result.limit.name == kExpectClash) {
      log_error("{}", result.meaning);
      continue;
    }
    log_error("{}: {} is {:.3f}, above the limit of {:g}", result.limit.name, result.meaning,
              result.figure, result.limit.bound);
  }
  return exit_code;
}

}  // namespace

int run_bot(const BotOptions& options) {
  std::optional<Play> play;
  if (options.behaviour == "script" && !options.observer) {
    auto read = read_play(options.play);
    if (!read) {
      log_error("{}", read.error().text);
      return exit_code_of(read.error().code);
    }
    play = std::move(*read);
  }
  std::signal(SIGINT, ask_to_stop);
  std::signal(SIGTERM, ask_to_stop);
  if (options.processes == 1) {
    ProcessReport report;
    const int exit_code = run_crew(options, std::move(play), report);
    return exit_code == kExitOk ? conclude(options, std::move(report.document)) : exit_code;
  }
  std::vector<ProcessReport> reports;
  const int exit_code = run_processes(
      options.processes,
      [&](int k, ProcessReport& report) { return run_share(options, k, report); }, reports);
  if (reports.empty()) return exit_code;
  const int concluded = conclude(options, merged(reports));
  return exit_code != kExitOk ? exit_code : concluded;
}

}  // namespace mortise
