#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "client/picture/picture.h"
#include "client/tools/judge/apply_way.h"
#include "client/tools/judge/judge_report.h"
#include "client/tools/judge/options.h"
#include "common/base/json_text.h"
#include "common/io/mesh/mesh_import.h"

namespace {

// Of the scene as it is, or after a motion that is told with it.
void show(const mortise::OpenedScene& opened, const mortise::JudgeReport& report,
          const mortise::JudgeOptions& o, const std::string& moved) {
  const bool color = isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
  std::string text;
  if (o.json) {
    mortise::Json json = mortise::judge_json(opened, report);
    if (!moved.empty()) json["moved"] = moved;
    text = mortise::json_text(json) + "\n";
  } else {
    text = (moved.empty() ? "" : moved + "\n") +
           mortise::judge_text(opened, report, {color, o.verbose});
  }
  std::fputs(text.c_str(), stdout);
}

}  // namespace

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
  if (!o.apply_way || !o.json) show(*opened, report, o, "");
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
    show(*opened, last, o, *moved);
  }
  const auto at_least = o.fail_on == "potential" ? mortise::CollisionClass::kPotential
                                                 : mortise::CollisionClass::kReal;
  return !o.fail_on.empty() && mortise::finds(last, at_least) ? mortise::kExitFindings
                                                              : mortise::kExitOk;
}
