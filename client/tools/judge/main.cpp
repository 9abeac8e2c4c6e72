#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "client/picture/picture.h"
#include "client/tools/judge/judge_report.h"
#include "client/tools/judge/options.h"
#include "common/base/json_text.h"
#include "common/io/mesh/mesh_import.h"

int main(int argc, char** argv) {
  const mortise::JudgeCommandLine line = mortise::read_judge_command_line(argc, argv);
  if (line.exit_code >= 0) return line.exit_code;
  const mortise::JudgeOptions& o = line.options;
  auto opened = mortise::is_mesh_name(o.files.front())
                    ? mortise::open_meshes(o.files, o.unit.empty() ? "mm" : o.unit, o.fit)
                    : mortise::open_scene(o.files.front());
  if (!opened) {
    std::fprintf(stderr, "mortise-judge: %s\n", opened.error().text.c_str());
    return mortise::kExitBadInput;
  }
  for (const mortise::Finding& finding : opened->findings)
    std::fprintf(stderr, "mortise-judge: %s\n", finding.text.c_str());
  if (!opened->usable()) return mortise::kExitBadInput;

  mortise::Scratch scratch(o.threads);
  const mortise::JudgeReport report =
      judge_world(opened->scene.world, scratch, o.full || !o.picture.empty());
  const bool color = isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
  const std::string text = o.json ? mortise::json_text(mortise::judge_json(*opened, report)) + "\n"
                                  : mortise::judge_text(*opened, report, {color, o.verbose});
  std::fputs(text.c_str(), stdout);
  if (!o.picture.empty())
    if (const auto drawn = mortise::draw_regions(opened->scene.world, report, o.regions, o.picture);
        !drawn) {
      std::fprintf(stderr, "mortise-judge: %s\n", drawn.error().text.c_str());
      return mortise::exit_code_of(drawn.error().code);
    }
  const auto at_least = o.fail_on == "potential" ? mortise::CollisionClass::kPotential
                                                 : mortise::CollisionClass::kReal;
  return !o.fail_on.empty() && mortise::finds(report, at_least) ? mortise::kExitFindings
                                                                : mortise::kExitOk;
}
