#include <CLI/CLI.hpp>

#include "client/replay/commands.h"
#include "common/base/result.h"

int main(int argc, char** argv) {
  CLI::App app("mortise-replay: computes recorded sessions again, and looks into their logs");
  app.require_subcommand(1);

  mortise::VerifyOptions verify;
  CLI::App* verify_command = app.add_subcommand(
      "verify", "compute the session again and compare every tick; exit 4 at the first difference");
  verify_command->add_option("log", verify.log, "session log (.mcap)")->required();
  verify_command
      ->add_option("--threads", verify.threads, "threads; the result does not depend on it")
      ->check(CLI::Range(1, 256));
  verify_command->add_flag("--json", verify.json, "one JSON document on stdout");

  mortise::VerifyOptions report;
  CLI::App* report_command = app.add_subcommand(
      "report", "verify, and print the statistics of the session: collisions by pair and user");
  report_command->add_option("log", report.log, "session log (.mcap)")->required();
  report_command->add_option("--threads", report.threads, "as with verify")
      ->check(CLI::Range(1, 256));
  report_command->add_flag("--json", report.json, "one JSON document on stdout");

  mortise::InfoOptions info;
  CLI::App* info_command = app.add_subcommand("info", "what a log holds, and what it lost");
  info_command->add_option("log", info.log, "session log (.mcap)")->required();
  info_command->add_flag("--json", info.json, "one JSON document on stdout");

  mortise::RecoverOptions recover;
  CLI::App* recover_command =
      app.add_subcommand("recover", "copy all that is whole into a new, closed log");
  recover_command->add_option("log", recover.log, "damaged session log")->required();
  recover_command->add_option("--out", recover.out, "new log; must not exist")->required();
  recover_command->add_flag("--json", recover.json, "one JSON document on stdout");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? mortise::kExitOk : mortise::kExitUsage;
  }
  if (verify_command->parsed()) return mortise::run_verify(verify);
  if (report_command->parsed()) return mortise::run_report(report);
  if (info_command->parsed()) return mortise::run_info(info);
  return mortise::run_recover(recover);
}
