#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>

#include "client/picture/picture.h"
#include "client/tools/judge/judge_report.h"
#include "common/base/json_text.h"
#include "common/io/build_info.h"

int main(int argc, char** argv) {
  std::string file, fail_on, picture;
  std::vector<std::size_t> regions;
  bool json = false, full = false;
  int threads = 1;
  CLI::App app("mortise-judge: judges all pairs of a scenario at its poses");
  app.set_version_flag("--version", mortise::version_line("mortise-judge"));
  app.add_option("scenario", file, "scenario file (.yaml)")->required();
  app.add_flag("--json", json, "one JSON document on stdout");
  app.add_flag("--full", full, "refine every bracket, not only until the class is decided");
  app.add_option("--fail-on", fail_on, "exit 6 when a collision of this class or worse is found")
      ->check(CLI::IsMember({"real", "potential"}));
  app.add_option("--picture", picture,
                 "draw the worst region in section, as .svg or .png; implies --full");
  app.add_option("--region", regions, "draw this region instead; several are drawn side by side");
  app.add_option("--threads", threads, "threads; the result does not depend on it")
      ->check(CLI::Range(1, 256));
  app.footer("Exit codes: 0 ok, 2 usage, 3 the scenario has errors, 6 --fail-on found something.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? mortise::kExitOk : mortise::kExitUsage;
  }
  auto opened = mortise::open_scene(file);
  if (!opened) {
    std::fprintf(stderr, "mortise-judge: %s\n", opened.error().text.c_str());
    return mortise::kExitBadInput;
  }
  for (const mortise::Finding& finding : opened->findings)
    std::fprintf(stderr, "mortise-judge: %s\n", finding.text.c_str());
  if (!opened->usable()) return mortise::kExitBadInput;

  mortise::Scratch scratch(threads);
  const mortise::JudgeReport report =
      judge_world(opened->scene.world, scratch, full || !picture.empty());
  const bool color = isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
  const std::string text = json ? mortise::json_text(mortise::judge_json(*opened, report)) + "\n"
                                : mortise::judge_text(*opened, report, color);
  std::fputs(text.c_str(), stdout);
  if (!picture.empty())
    if (const auto drawn = mortise::draw_regions(opened->scene.world, report, regions, picture);
        !drawn) {
      std::fprintf(stderr, "mortise-judge: %s\n", drawn.error().text.c_str());
      return mortise::exit_code_of(drawn.error().code);
    }
  const auto at_least =
      fail_on == "potential" ? mortise::CollisionClass::kPotential : mortise::CollisionClass::kReal;
  return !fail_on.empty() && mortise::finds(report, at_least) ? mortise::kExitFindings
                                                              : mortise::kExitOk;
}
