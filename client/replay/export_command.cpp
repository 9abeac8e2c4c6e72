#include "client/replay/export_command.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <thread>

#include "client/replay/output.h"
#include "client/replay/progress.h"
#include "client/replay/sweep.h"
#include "client/report/bcf.h"
#include "client/report/export_files.h"
#include "client/report/export_html.h"
#include "client/report/export_sqlite.h"
#include "client/report/report.h"
#include "client/saved/saved_session.h"
#include "client/saved/unpack.h"
#include "common/base/json_text.h"
#include "common/io/log/replay.h"
#include "common/session/tick/statistics.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

Result<StepCounters> coverage_of(const SessionLog& log) {
  auto scene = scene_of(log);
  if (!scene) return scene.error();
  StepCounters sum;
  const double last = log.ticks.empty() ? 1.0 : static_cast<double>(log.ticks.back().tick);
  Progress progress("computing again", last);
  const auto done = recompute(scene->world, log, 1, [&](const ReplayedTick& tick) {
    accumulate(sum, tick.computed.counters);
    progress.show(static_cast<double>(tick.computed.tick));
  });
  if (!done) return done.error();
  return sum;
}

// The table of a what-if; nothing where none was asked for.
Result<std::vector<Table>> what_if_tables(const SessionLog& log, const ExportOptions& options) {
  if (options.sweep.empty()) return std::vector<Table>();
  const auto all = combinations({}, options.sweep);
  if (!all) return all.error();
  std::vector<Variant> variants;
  for (const auto& changes : *all) variants.push_back({variants.size(), changes, {}, ""});
  const int jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  if (const Status status = check_variants(log, variants, jobs); !status) return status.error();
  const auto before = clashes_with(log, {});
  if (!before) return before.error();
  Progress progress("variants", static_cast<double>(variants.size()));
  compute_variants(log, variants, jobs,
                   [&](std::size_t done) { progress.show(static_cast<double>(done)); });
  using Type = Table::Type;
  Table table{"what_if",
              "the session computed again with changes: clashes by class, and how many are of "
              "another class, begun or gone",
              {{"changes", Type::kText},
               {"real", Type::kInteger},
               {"potential", Type::kInteger},
               {"fake", Type::kInteger},
               {"changed", Type::kInteger},
               {"no_answer", Type::kText}},
              {}};
  for (const WhatIfRow& row : rows_of(*before, variants))
    table.rows.push_back({row.changes, row.real, row.potential, row.fake, row.changed, row.error});
  return std::vector<Table>{table};
}

Status write_file(const fs::path& file, const std::function<void(std::ostream&)>& put) {
  std::ofstream out(file, std::ios::binary);
  put(out);
  return out.flush() ? ok() : Status(fail(Code::kRuntime, file.string() + " could not be written"));
}
Status write_text(const fs::path& file, const std::string& text) {
  return write_file(file, [&](std::ostream& out) { out << text; });
}

// What a scenario cannot hold is said on stderr.
Status save_scenario(const SessionLog& log, const std::filesystem::path& folder) {
  const double last = log.ticks.empty() ? 1.0 : static_cast<double>(log.ticks.back().tick);
  Progress progress("computing again", last);
  const auto saved = saved_session(log, [&](const ReplayedTick& tick) {
    progress.show(static_cast<double>(tick.computed.tick));
  });
  progress.end();
  if (!saved) return saved.error();
  if (!saved->stopped_early.empty()) std::cerr << saved->stopped_early << "\n";
  for (const std::string& line : saved->scenario.left_out)
    std::cerr << "not kept: " << line << "\n";
  return write_folder(saved->scenario, folder);
}

}  // namespace

int run_export(const ExportOptions& options) {
  if (options.only_scenario() && options.scenario.empty())
    return say(fail(Code::kInvalidInput,
                    "export what? --csv, --sqlite, --html, --json, --bcf or --scenario"),
               kExitUsage);
  const auto log = read_files(options.log, options.more);
  if (!log) return say(log.error(), kExitBadInput);
  print_notes(*log);
  if (!options.scenario.empty()) {
    if (const Status saved = save_scenario(*log, options.scenario); !saved)
      return say(saved.error(), kExitBadInput);
    if (options.only_scenario()) return kExitOk;
  }
  std::optional<StepCounters> coverage;
  if (options.recompute) {
    const auto counted = coverage_of(*log);
    if (!counted) return say(counted.error(), kExitBadInput);
    coverage = *counted;
  }
  auto what_if = what_if_tables(*log, options);
  if (!what_if) return say(what_if.error(), kExitUsage);
  ReportWishes wishes;
  wishes.coverage = coverage;
  wishes.more = std::move(*what_if);
  if (options.html.empty() && options.bcf.empty()) wishes.pictures = {0, 0};
  wishes.pictures.png = !options.bcf.empty();
  Progress progress("drawing", 1.0);
  wishes.on_progress = [&](double share) { progress.show(share); };
  const auto report = report_of(*log, wishes);
  progress.end();
  if (!report) return say(report.error(), kExitBadInput);
  const std::vector<Table>& tables = report->tables;
  Status status = ok();
  if (!options.csv.empty()) status = write_csv(tables, options.csv);
  if (status && !options.sqlite.empty()) status = write_sqlite(tables, options.sqlite);
  if (status && !options.html.empty()) status = write_text(options.html, html_of(*report));
  if (status && !options.json.empty())
    status = write_text(options.json, json_text(json_of(tables), 1));
  if (status && !options.bcf.empty()) status = write_bcf(*report, *log, options.bcf);
  return status ? kExitOk : say(status.error(), kExitRuntime);
}

int run_unpack(const UnpackOptions& options) {
  const Status done = unpack(options.archive, options.out);
  return done ? kExitOk
              : say(done.error(),
                    done.error().code == Code::kRuntime ? kExitRuntime : kExitBadInput);
}

}  // namespace mortise
