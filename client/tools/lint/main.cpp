#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "client/tools/lint/lint.h"
#include "common/base/json_text.h"
#include "common/io/build_info.h"
#include "common/io/usage.h"

int main(int argc, char** argv) {
  std::string file;
  bool json = false;
  mortise::ProgramOptions app(
      "mortise-lint: checks a scenario and prints its tolerances in micrometres",
      mortise::version_line("mortise-lint"));
  app.add("scenario", file, "scenario file (.yaml)").reads_file().required();
  app.add_flag("--json", json, "one JSON document on stdout");
  app.footer(
      "Exit codes: 0 ok (warnings allowed), 1 cannot write, 2 usage, 3 the scenario has errors.");
  if (const int exit_code = app.read(argc, argv); exit_code >= 0) return exit_code;
  auto opened = mortise::open_scene(file);
  if (!opened) {
    std::fprintf(stderr, "mortise-lint: %s\n", opened.error().text.c_str());
    return mortise::kExitBadInput;
  }
  if (const auto still = mortise::nothing_moves(opened->scenario); still && opened->usable())
    opened->findings.push_back(*still);
  const bool color = isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
  const std::string text = json ? mortise::json_text(mortise::lint_json(*opened)) + "\n"
                                : mortise::lint_text(*opened, color);
  std::fputs(text.c_str(), stdout);
  return opened->usable() ? mortise::kExitOk : mortise::kExitBadInput;
}
