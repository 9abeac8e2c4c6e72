#include "client/replay/options.h"

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

void add_verify(ProgramOptions& app, int& code) {
  auto options = std::make_shared<VerifyOptions>();
  auto command = app.add_command(
      "verify", "compute the session again and compare every tick; exit 4 at the first difference",
      [options, &code] { code = run_verify(*options); });
  command.add("log", options->log, "session log (.mcap)").reads_file().required();
  command.add("more", options->more, kMore).reads_file();
  command.add("--threads", options->threads, "threads; the result does not depend on it")
      .in_range(1, 256);
  command.add("--signed", options->signed_by,
              "and prove that it is unchanged since servers of this site signed it: the folder of "
              "the site's authority, or of any keys of it (mortise keys)");
  command.add_flag("--json", options->json, kJson);
}

void add_report(ProgramOptions& app, int& code) {
  auto options = std::make_shared<VerifyOptions>();
  auto command = app.add_command(
      "report", "verify, and print the statistics of the session: collisions by pair and user",
      [options, &code] { code = run_report(*options); });
  command.add("log", options->log, "session log (.mcap)").reads_file().required();
  command.add("more", options->more, kMore).reads_file();
  command.add("--threads", options->threads, "as with verify").in_range(1, 256);
  command.add_flag("--json", options->json, kJson);
}

void add_info(ProgramOptions& app, int& code) {
  auto options = std::make_shared<InfoOptions>();
  auto command = app.add_command("info", "what a log holds, and what it lost",
                                 [options, &code] { code = run_info(*options); });
  command.add("log", options->log, "session log (.mcap)").reads_file().required();
  command.add("more", options->more, kMore).reads_file();
  command.add_flag("--json", options->json, kJson);
}

void add_recover(ProgramOptions& app, int& code) {
  auto options = std::make_shared<RecoverOptions>();
  auto command = app.add_command(
      "recover", "copy all that is whole into a new, closed log; exit 7: it is not replayable",
      [options, &code] { code = run_recover(*options); });
  command.add("log", options->log, "damaged session log").reads_file().required();
  command.add("--out", options->out, "new log; must not exist").writes_file().required();
  command.add_flag("--json", options->json, kJson);
}

void add_export(ProgramOptions& app, int& code) {
  auto options = std::make_shared<ExportOptions>();
  auto command =
      app.add_command("export", "the session as tables: clashes, events, users, decisions, sums",
                      [options, &code] { code = run_export(*options); });
  command.add("log", options->log, "session log (.mcap)").reads_file().required();
  command.add("more", options->more, kMore).reads_file();
  command.add("--csv", options->csv, "a folder for one CSV file a table").writes_file();
  command.add("--sqlite", options->sqlite, "a new SQLite database, with views").writes_file();
  command.add("--html", options->html, "one page that needs no other file").writes_file();
  command.add("--json", options->json, "one JSON document").writes_file();
  command
      .add("--bcf", options->bcf, "a new BCF 3.0 archive: each clash as an issue, with a picture")
      .writes_file();
  command
      .add("--scenario", options->scenario,
           "a new folder for a scenario, with its meshes, that begins where the session stands")
      .writes_file();
  command
      .add("--what-if", options->sweep,
           "changes as behind --sweep of whatif; their table goes with the others")
      .one_at_a_time();
  command.add_flag("--recompute", options->recompute,
                   "compute the session again for what was examined and skipped");
}

void add_unpack(ProgramOptions& app, int& code) {
  auto options = std::make_shared<UnpackOptions>();
  auto command = app.add_command(
      "unpack", "a session that was saved on the page, as a folder with its scenario",
      [options, &code] { code = run_unpack(*options); });
  command.add("archive", options->archive, "what Save wrote (.zip)").reads_file().required();
  command.add("--out", options->out, "a new folder").writes_file().required();
}

void add_explain(ProgramOptions& app, int& code) {
  auto options = std::make_shared<ExplainOptions>();
  auto command = app.add_command(
      "explain", "the whole chain that led to the verdict of one clash, in words and numbers",
      [options, &code] { code = run_explain(*options); });
  command.add("log", options->log, "session log (.mcap)").reads_file().required();
  command.add("clash", options->clash, "its number, as in the tables").required();
  command.add("--tick", options->tick, "what was told in this tick; default: the worst");
  command.add_flag("--json", options->json, kJson);
}

void add_play([[maybe_unused]] ProgramOptions& app, [[maybe_unused]] int& code) {
#ifdef MORTISE_WITH_DDS
  auto options = std::make_shared<PlayCommand>();
  PlayCommand& o = *options;
  auto command = app.add_command(
      "play", "send what the users of a log did to a live session with the same parts, again",
      [options, &code] { code = run_play(*options); });
  command.add("log", o.log, "session log (.mcap)").reads_file().required();
  add_client_network_options(command, o.network);
  command.add("--speed", o.speed, "times the recorded pace").in_range(0.1, 100.0).shows_default();
  command.add("--from", o.from_s, "s of the log; what lies before is played at ×100")
      .not_negative();
  command.add("--to", o.to_s, "s of the log; default: its end").positive();
  command.add("--wait", o.wait_s, "s to wait for the session").positive();
  command.add_flag("--json", o.json, kJson);
#endif
}

void add_what_if(ProgramOptions& app, int& code) {
  auto options = std::make_shared<WhatIfOptions>();
  auto command = app.add_command(
      "whatif", "compute the session with changes: which clashes have another class, and why",
      [options, &code] { code = run_what_if(*options); });
  command.footer(kChanges);
  command.add("log", options->log, "session log (.mcap)").reads_file().required();
  command.add("--set", options->set, "a change; may be given again").one_at_a_time();
  command.add("--sweep", options->sweep, "a change with values in brackets; again: each with each")
      .one_at_a_time();
  options->jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  command.add("--jobs", options->jobs, "variants computed at a time; default: the cores")
      .shows_default()
      .in_range(1, 256);
  command.add_word(
      "--shard",
      [options](const std::string& text) {
        char rest = 0;
        if (std::sscanf(text.c_str(), "%d/%d%c", &options->shard, &options->shards, &rest) != 2 ||
            options->shard < 1 || options->shard > options->shards)
          throw UsageError("--shard: " + text + ": I/N, I from 1 to N");
      },
      "I/N: of all variants only every N-th, for several machines; see merge");
  command.add_flag("--json", options->json, kJson);
}

void add_merge(ProgramOptions& app, int& code) {
  auto options = std::make_shared<MergeOptions>();
  auto command = app.add_command("merge", "put the JSON of all shards of one sweep together",
                                 [options, &code] { code = run_merge(*options); });
  command.add("files", options->files, "documents of whatif --json --shard")
      .reads_file()
      .required();
}

}  // namespace

int run_replay_program(int argc, char** argv) {
  ProgramOptions app("mortise-replay: computes recorded sessions again, and looks into their logs",
                     version_line("mortise-replay"));
  int code = kExitOk;
  add_verify(app, code);
  add_report(app, code);
  add_info(app, code);
  add_recover(app, code);
  add_export(app, code);
  add_unpack(app, code);
  add_explain(app, code);
  add_play(app, code);
  add_what_if(app, code);
  add_merge(app, code);
  const int exit_code = app.read(argc, argv);
  return exit_code >= 0 ? exit_code : code;
}

}  // namespace mortise
