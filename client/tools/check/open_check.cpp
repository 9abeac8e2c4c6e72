#include "client/tools/check/open_check.h"

#include "common/io/mesh/mesh_import.h"
#include "common/io/step/step_import.h"

namespace mortise {

namespace fs = std::filesystem;

fs::path statements_beside(const fs::path& step) {
  return fs::path(step).replace_extension(".mortise.yaml");
}

Result<OpenedScene> open_check(const CheckCommand& command) {
  const fs::path file = command.files.front();
  if (!is_step_name(file) && is_mesh_name(file))
    return open_meshes(command.files, command.unit.empty() ? "mm" : command.unit, command.fit);
  AssemblyWishes wishes{command.general, command.bought, {}, {}};
  if (command.check.exact_volumes) wishes.then = AfterReading::kKeepSolids;
  if (!is_step_name(file)) return open_scene(file, wishes);
  const fs::path statements = statements_beside(file);
  return fs::exists(statements) ? open_scene(statements, wishes) : open_assembly(file, wishes);
}

}  // namespace mortise
