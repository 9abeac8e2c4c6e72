#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>

#include "client/tools/inspect/inspect.h"
#include "common/base/json_text.h"
#include "common/io/build_info.h"

int main(int argc, char** argv) {
  const std::map<std::string, double> units{
      {"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}, {"in", 25.4}, {"um", 1e-3}};
  std::vector<std::string> files;
  std::string unit = "mm";
  bool json = false;
  CLI::App app(
      "mortise-inspect: planes, cylinders, cones, spheres and tori of meshes, and what a scenario "
      "could say of them");
  app.set_version_flag("--version", mortise::version_line("mortise-inspect"));
  app.add_option("files", files, "mesh files, or one scenario (.yaml)")->required();
  app.add_option("--unit", unit, "of the numbers in mesh files: mm, cm, m, in, um")
      ->check(CLI::IsMember({"mm", "cm", "m", "in", "um"}))
      ->capture_default_str();
  app.add_flag("--json", json, "one JSON document on stdout");
  app.footer("Exit codes: 0 ok, 2 usage, 3 a file cannot be used.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? mortise::kExitOk : mortise::kExitUsage;
  }
  const auto parts = mortise::inspect_files(files, unit, units.at(unit));
  if (!parts) {
    std::fprintf(stderr, "mortise-inspect: %s\n", parts.error().text.c_str());
    return mortise::kExitBadInput;
  }
  const std::string text = json ? mortise::json_text(mortise::inspect_json(*parts)) + "\n"
                                : mortise::inspect_text(*parts);
  std::fputs(text.c_str(), stdout);
  return mortise::kExitOk;
}
