#include <cstdio>

#include "client/picture/picture.h"
#include "client/tools/judge/apply_way.h"
#include "client/tools/judge/judge_report.h"
#include "client/tools/judge/options.h"
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
  if (!o.apply_way || !o.json) std::fputs(mortise::judged(*opened, report, o).c_str(), stdout);
  if (!o.picture.empty())
    if (const auto drawn = mortise::draw_regions(opened->scene.world, report, o.regions, o.picture);
        !drawn) {
      std::fprintf(stderr, "mortise-judge: %s\n", drawn.error().text.c_str());
      return mortise::exit_code_of(drawn.error().code);
    }
  mortise::JudgeReport last = report;
  if (o.apply_way) {
    const auto moved =
        mortise::apply_way(opened->scene.world, report, o.regions.empty() ? 0 : o.regions.front());
    if (!moved) {
      std::fprintf(stderr, "mortise-judge: %s\n", moved.error().text.c_str());
      return mortise::exit_code_of(moved.error().code);
    }
    last = mortise::judge_world(opened->scene.world, scratch, o.full);
    std::fputs(mortise::judged(*opened, last, o, *moved).c_str(), stdout);
  }
  const auto at_least = o.fail_on == "potential" ? mortise::CollisionClass::kPotential
                                                 : mortise::CollisionClass::kReal;
  return !o.fail_on.empty() && mortise::finds(last, at_least) ? mortise::kExitFindings
                                                              : mortise::kExitOk;
}
