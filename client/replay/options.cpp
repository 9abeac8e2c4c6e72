#include "client/replay/options.h"

#include <CLI/CLI.hpp>
#include <thread>

#include "client/replay/commands.h"
#include "client/replay/export_command.h"
#include "client/replay/play_command.h"
#include "client/replay/what_if_command.h"
#include "common/base/result.h"
#include "common/io/build_info.h"
#include "common/io/usage.h"
#include "idl/network_options.h"

namespace mortise {
namespace {

constexpr const char* kJson = "one JSON document on stdout";
constexpr const char* kMore =
    "further files of the session, in order; none: what goes on from LOG in its folder";
constexpr const char* kChanges = R"(
Changes:
  policy = report                            stop, slide, report
  tolerance PART[.FEATURE] = ±0.02           as behind tolerance: or iso: of a scenario; empty: nothing
  fit PART[.FEATURE], PART[.FEATURE] = H7/p6
  exclude PART, PART = reason                include PART, PART
  mesh PART = FILE                           numbers in mm
A sweep has values in brackets: 'tolerance peg = ±[0.01, 0.02]', 'tolerance peg = ±[0.01..0.05/5]'.)";

void add_verify(CLI::App& app, int& code) {
  auto options = std::make_shared<VerifyOptions>();
  auto* command = app.add_subcommand(
      "verify", "compute the session again and compare every tick; exit 4 at the first difference");
  command->add_option("log", options->log, "session log (.mcap)")->required();
  command->add_option("more", options->more, kMore);
  command->add_option("--threads", options->threads, "threads; the result does not depend on it")
      ->check(CLI::Range(1, 256));
  command->add_flag("--json", options->json, kJson);
  command->callback([options, &code] { code = run_verify(*options); });
}

void add_report(CLI::App& app, int& code) {
  auto options = std::make_shared<VerifyOptions>();
  auto* command = app.add_subcommand(
      "report", "verify, and print the statistics of the session: collisions by pair and user");
  command->add_option("log", options->log, "session log (.mcap)")->required();
  command->add_option("more", options->more, kMore);
  command->add_option("--threads", options->threads, "as with verify")->check(CLI::Range(1, 256));
  command->add_flag("--json", options->json, kJson);
  command->callback([options, &code] { code = run_report(*options); });
}

void add_info(CLI::App& app, int& code) {
  auto options = std::make_shared<InfoOptions>();
  auto* command = app.add_subcommand("info", "what a log holds, and what it lost");
  command->add_option("log", options->log, "session log (.mcap)")->required();
  command->add_option("more", options->more, kMore);
  command->add_flag("--json", options->json, kJson);
  command->callback([options, &code] { code = run_info(*options); });
}

void add_recover(CLI::App& app, int& code) {
  auto options = std::make_shared<RecoverOptions>();
  auto* command = app.add_subcommand("recover", "copy all that is whole into a new, closed log");
  command->add_option("log", options->log, "damaged session log")->required();
  command->add_option("--out", options->out, "new log; must not exist")->required();
  command->add_flag("--json", options->json, kJson);
  command->callback([options, &code] { code = run_recover(*options); });
}

void add_export(CLI::App& app, int& code) {
  auto options = std::make_shared<ExportOptions>();
  auto* command = app.add_subcommand(
      "export", "the session as tables: clashes, events, users, decisions, sums");
  command->add_option("log", options->log, "session log (.mcap)")->required();
  command->add_option("more", options->more, kMore);
  command->add_option("--csv", options->csv, "a folder for one CSV file a table");
  command->add_option("--sqlite", options->sqlite, "a new SQLite database, with views");
  command->add_option("--html", options->html, "one page that needs no other file");
  command->add_option("--json", options->json, "one JSON document");
  command->add_option("--bcf", options->bcf,
                      "a new BCF 3.0 archive: each clash as an issue, with a picture");
  command
      ->add_option("--what-if", options->sweep,
                   "changes as behind --sweep of whatif; their table goes with the others")
      ->allow_extra_args(false);
  command->add_flag("--recompute", options->recompute,
                    "compute the session again for what was examined and skipped");
  command->callback([options, &code] { code = run_export(*options); });
}

void add_explain(CLI::App& app, int& code) {
  auto options = std::make_shared<ExplainOptions>();
  auto* command = app.add_subcommand(
      "explain", "the whole chain that led to the verdict of one clash, in words and numbers");
  command->add_option("log", options->log, "session log (.mcap)")->required();
  command->add_option("clash", options->clash, "its number, as in the tables")->required();
  command->add_option("--tick", options->tick, "what was told in this tick; default: the worst");
  command->add_flag("--json", options->json, kJson);
  command->callback([options, &code] { code = run_explain(*options); });
}

void add_play([[maybe_unused]] CLI::App& app, [[maybe_unused]] int& code) {
#ifdef MORTISE_WITH_DDS
  auto options = std::make_shared<PlayCommand>();
  PlayCommand& o = *options;
  auto* command = app.add_subcommand(
      "play", "send what the users of a log did to a live session with the same parts, again");
  command->add_option("log", o.log, "session log (.mcap)")->required();
  add_client_network_options(*command, o.network);
  command->add_option("--speed", o.speed, "times the recorded pace")
      ->check(CLI::Range(0.1, 100.0))
      ->capture_default_str();
  command->add_option("--from", o.from_s, "s of the log; what lies before is played at ×100")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--to", o.to_s, "s of the log; default: its end")->check(CLI::PositiveNumber);
  command->add_option("--wait", o.wait_s, "s to wait for the session")->check(CLI::PositiveNumber);
  command->add_flag("--json", o.json, kJson);
  command->callback([options, &code] { code = run_play(*options); });
#endif
}

void add_what_if(CLI::App& app, int& code) {
  auto options = std::make_shared<WhatIfOptions>();
  auto* command = app.add_subcommand(
      "whatif", "compute the session with changes: which clashes have another class, and why");
  command->footer(kChanges);
  command->add_option("log", options->log, "session log (.mcap)")->required();
  command->add_option("--set", options->set, "a change; may be given again")
      ->allow_extra_args(false);
  command
      ->add_option("--sweep", options->sweep,
                   "a change with values in brackets; again: each with each")
      ->allow_extra_args(false);
  command->add_option("--jobs", options->jobs, "variants computed at a time; default: the cores")
      ->default_val(std::max(1U, std::thread::hardware_concurrency()))
      ->check(CLI::Range(1, 256));
  command->add_option_function<std::string>(
      "--shard",
      [options](const std::string& text) {
        char rest = 0;
        if (std::sscanf(text.c_str(), "%d/%d%c", &options->shard, &options->shards, &rest) != 2 ||
            options->shard < 1 || options->shard > options->shards)
          throw CLI::ValidationError("--shard", text + ": I/N, I from 1 to N");
      },
      "I/N: of all variants only every N-th, for several machines; see merge");
  command->add_flag("--json", options->json, kJson);
  command->callback([options, &code] { code = run_what_if(*options); });
}

void add_merge(CLI::App& app, int& code) {
  auto options = std::make_shared<MergeOptions>();
  auto* command = app.add_subcommand("merge", "put the JSON of all shards of one sweep together");
  command->add_option("files", options->files, "documents of whatif --json --shard")->required();
  command->callback([options, &code] { code = run_merge(*options); });
}

}  // namespace

int run_replay_program(int argc, char** argv) {
  CLI::App app("mortise-replay: computes recorded sessions again, and looks into their logs");
  app.set_version_flag("--version", version_line("mortise-replay"));
  app.require_subcommand(1);
  int code = kExitOk;
  add_verify(app, code);
  add_report(app, code);
  add_info(app, code);
  add_recover(app, code);
  add_export(app, code);
  add_explain(app, code);
  add_play(app, code);
  add_what_if(app, code);
  add_merge(app, code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return exit_of_usage(app, error);
  }
  return code;
}

}  // namespace mortise
