#include <cstdio>

#include "client/tools/inspect/inspect.h"
#include "client/tools/inspect/inspect_step.h"
#include "client/tools/inspect/propose.h"
#include "common/base/json_text.h"
#include "common/base/length_unit.h"
#include "common/io/build_info.h"
#include "common/io/step/step_import.h"
#include "common/io/usage.h"

int main(int argc, char** argv) {
  std::vector<std::string> files;
  std::string unit = "mm";
  bool json = false;
  mortise::ProgramOptions app(
      "mortise-inspect: planes, cylinders, cones, spheres and tori of meshes on stderr, and a "
      "scenario of them on stdout",
      mortise::version_line("mortise-inspect"));
  app.add("files", files, "mesh files, one scenario (.yaml), or one STEP assembly")
      .reads_file()
      .required();
  app.add("--unit", unit, "of the numbers in mesh files: mm, cm, m, in, um")
      .one_of(mortise::length_unit_names())
      .shows_default();
  app.add_flag("--json", json, "one JSON document on stdout");
  app.footer(
      "mortise-inspect a.stl b.stl > scene.yaml writes a scenario that can be judged as it stands."
      "\nExit codes: 0 ok, 1 cannot write, 2 usage, 3 a file cannot be used, 7 "
      "not all of a STEP file could be read.");
  if (const int exit_code = app.read(argc, argv); exit_code >= 0) return exit_code;
  if (files.size() == 1 && mortise::is_step_name(files.front()))
    return mortise::inspect_step(files.front(), json);
  const auto parts = mortise::inspect_files(files, *mortise::length_unit_mm(unit));
  if (!parts) {
    std::fprintf(stderr, "mortise-inspect: %s\n", parts.error().text.c_str());
    return mortise::kExitBadInput;
  }
  if (!json) std::fputs(mortise::inspect_text(*parts).c_str(), stderr);
  const std::string text = json ? mortise::json_text(mortise::inspect_json(*parts)) + "\n"
                                : mortise::proposed_yaml(*parts);
  std::fputs(text.c_str(), stdout);
  return mortise::kExitOk;
}
