#include "client/tools/generate/options.h"

#include <cstdlib>
#include <vector>

#include "common/base/result.h"
#include "common/io/build_info.h"
#include "common/io/usage.h"

namespace mortise {

GenerateCommandLine read_generate_command_line(int argc, char** argv) {
  GenerateCommandLine line;
  GenerateOptions& o = line.options;
  ProgramOptions app(
      "mortise-generate: writes a generated part, or the parts of a scenario, as a mesh, in mm",
      version_line("mortise-generate"));
  app.add_flag("--list", o.list, "Say which kinds there are and what parameters they have");
  app.add("kind", o.kind, "Kind of part, e.g. shaft");
  std::vector<std::string> words;
  app.add("parameters", words, "name=value, e.g. d1_mm=20 facets=48 phase_rad=0.1");
  app.add("--scene", o.scene, "Scenario file: all its parts at their poses, as .obj and .mtl")
      .reads_file();
  app.add("-o,--out", o.out, "File to write: .obj (all digits) or .stl (floats)").writes_file();
  app.footer("Exit codes: 0 ok, 1 cannot write, 2 usage, 3 the part cannot be made.");
  const auto wrong = [&](const std::string& text) {
    std::fprintf(stderr, "mortise-generate: %s; see mortise-generate --help\n", text.c_str());
    line.exit_code = kExitUsage;
    return line;
  };
  if (const int exit_code = app.read(argc, argv); exit_code >= 0) {
    line.exit_code = exit_code;
    return line;
  }
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) return wrong("'" + word + "' is not name=value");
    char* end = nullptr;
    const std::string value = word.substr(equals + 1);
    o.parameters[word.substr(0, equals)] = std::strtod(value.c_str(), &end);
    if (value.empty() || *end != '\0') return wrong("'" + word + "' does not end in a number");
  }
  if (o.list) return line;
  if (!o.scene.empty() && (!o.kind.empty() || !o.out.ends_with(".obj")))
    return wrong("--scene takes no kind of part and writes to --out FILE.obj");
  if (o.scene.empty() && o.kind.empty())
    return wrong("name a kind of part, --scene FILE or --list");
  if (!o.out.ends_with(".obj") && !o.out.ends_with(".stl"))
    return wrong("say where to write with --out FILE.obj or --out FILE.stl");
  return line;
}

}  // namespace mortise
