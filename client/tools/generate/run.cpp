#include "client/tools/generate/run.h"

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "client/tools/generate/write_mesh.h"
#include "client/tools/generate/write_scene.h"
#include "common/generators/generators.h"
#include "common/io/scenario/open_scene.h"
#include "common/io/usage.h"

namespace mortise {
namespace {

int list_generators() {
  for (const GeneratorInfo& info : generators()) {
    std::printf("%s: %s\n", info.name.c_str(), info.what.c_str());
    for (const auto& p : info.parameters)
      std::printf("  %-18s %g (%g to %g): %s\n", p.name.c_str(), p.fallback, p.least, p.most,
                  p.what.c_str());
  }
  return kExitOk;
}

int complain(ExitCode code, const std::string& text) {
  std::fprintf(stderr, "mortise-generate: %s\n", text.c_str());
  return code;
}

int write_part(const GenerateOptions& options) {
  const auto part = generate(options.kind, options.parameters);
  if (!part) return complain(kExitBadInput, part.error().text);
  std::ofstream out(options.out, std::ios::binary);
  options.out.ends_with(".obj") ? write_obj(part->mesh, part->features, out)
                                : write_stl(part->mesh, out);
  out.close();
  if (!out) return complain(kExitRuntime, options.out + " cannot be written");
  std::printf("%s: %zu points, %zu triangles, hash %s\n", options.out.c_str(),
              part->mesh.points_mm.size(), part->mesh.triangles.size(),
              mesh_hash(part->mesh).c_str());
  return kExitOk;
}

int write_scene(const GenerateOptions& options) {
  const auto opened = open_scene(options.scene);
  if (!opened) return complain(kExitBadInput, opened.error().text);
  for (const Finding& finding : opened->findings)
    if (finding.is_error) return complain(kExitBadInput, finding.text);
  if (const Status kept = none_is_written(files_of(opened->scenario)); !kept)
    return complain(kExitBadInput, kept.error().text);
  const auto material_file = std::filesystem::path(options.out).replace_extension(".mtl");
  std::ofstream out(options.out), materials(material_file);
  write_scene_obj(opened->scene.world, material_file.filename().string(), out, materials);
  out.close();
  materials.close();
  if (!out || !materials) return complain(kExitRuntime, options.out + " cannot be written");
  std::printf("%s: %zu parts\n", options.out.c_str(), opened->scene.world.parts.size());
  return kExitOk;
}

}  // namespace

int run_generate(const GenerateOptions& options) {
  if (options.list) return list_generators();
  return options.scene.empty() ? write_part(options) : write_scene(options);
}

}  // namespace mortise
