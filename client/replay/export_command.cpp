#include <fstream>
#include <iostream>

#include "client/replay/commands.h"
#include "client/replay/export.h"
#include "client/replay/output.h"
#include "common/io/replay.h"
#include "common/session/statistics.h"

namespace mortise {
namespace {

Result<StepCounters> coverage_of(const SessionLog& log) {
  auto scene = scene_of(log);
  if (!scene) return scene.error();
  StepCounters sum;
  const auto done = recompute(scene->world, log, 1, [&](const ReplayedTick& tick) {
    accumulate(sum, tick.computed.counters);
  });
  if (!done) return done.error();
  return sum;
}

Status write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  return out.flush() ? ok() : Status(fail(Code::kRuntime, file.string() + " could not be written"));
}

}  // namespace

int run_export(const ExportOptions& options) {
  if (options.csv.empty() && options.sqlite.empty() && options.html.empty() && options.json.empty())
    return say(fail(Code::kInvalidInput, "export what? --csv, --sqlite, --html or --json"),
               kExitUsage);
  const auto log = read_session_log(options.log);
  if (!log) return say(log.error(), kExitBadInput);
  print_notes(*log);
  std::optional<StepCounters> coverage;
  if (options.recompute) {
    const auto counted = coverage_of(*log);
    if (!counted) return say(counted.error(), kExitBadInput);
    coverage = *counted;
  }
  const auto tables = tables_of(*log, coverage);
  if (!tables) return say(tables.error(), kExitBadInput);
  Status status = ok();
  if (!options.csv.empty()) status = write_csv(*tables, options.csv);
  if (status && !options.sqlite.empty()) status = write_sqlite(*tables, options.sqlite);
  if (status && !options.html.empty())
    status = write_text(options.html, html_of(*tables, "Clashes of " + log->session));
  if (status && !options.json.empty())
    status = write_text(options.json,
                        json_of(*tables).dump(1, ' ', false, Json::error_handler_t::replace));
  return status ? kExitOk : say(status.error(), kExitRuntime);
}

}  // namespace mortise
