#include <cstdio>
#include <fstream>

#include "client/tools/generate/options.h"
#include "client/tools/generate/write_mesh.h"
#include "scenarios/generators/generators.h"

namespace {

void list_generators() {
  for (const mortise::GeneratorInfo& info : mortise::generators()) {
    std::printf("%s: %s\n", info.name.c_str(), info.what.c_str());
    for (const auto& p : info.parameters)
      std::printf("  %-18s %g (%g to %g): %s\n", p.name.c_str(), p.fallback, p.least, p.most,
                  p.what.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const mortise::GenerateCommandLine line = mortise::read_generate_command_line(argc, argv);
  if (line.exit_code) return *line.exit_code;
  const mortise::GenerateOptions& options = line.options;
  if (options.list) {
    list_generators();
    return mortise::kExitOk;
  }
  const auto part = mortise::generate(options.kind, options.parameters);
  if (!part) {
    std::fprintf(stderr, "mortise-generate: %s\n", part.error().text.c_str());
    return mortise::kExitBadInput;
  }
  std::ofstream out(options.out, std::ios::binary);
  options.out.ends_with(".obj") ? mortise::write_obj(part->mesh, part->features, out)
                                : mortise::write_stl(part->mesh, out);
  out.close();
  if (!out) {
    std::fprintf(stderr, "mortise-generate: %s cannot be written\n", options.out.c_str());
    return mortise::kExitRuntime;
  }
  std::printf("%s: %zu points, %zu triangles, hash %s\n", options.out.c_str(),
              part->mesh.points_mm.size(), part->mesh.triangles.size(),
              mortise::mesh_hash(part->mesh).c_str());
  return mortise::kExitOk;
}
