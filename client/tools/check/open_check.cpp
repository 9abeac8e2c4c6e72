#include "client/tools/check/open_check.h"

#include "common/io/mesh/mesh_import.h"
#include "common/io/step/step_import.h"

namespace mortise {

namespace fs = std::filesystem;

fs::path statements_beside(const fs::path& step) {
  return fs::path(step).replace_extension(".mortise.yaml");
}

Result<CheckSubject> open_check(const CheckCommand& command) {
  const fs::path file = command.files.front();
  const AssemblyWishes wishes{command.general, command.bought, {}};
  Result<OpenedScene> opened =
      is_step_name(file)
          ? (fs::exists(statements_beside(file)) ? open_scene(statements_beside(file), wishes)
                                                 : open_assembly(file, wishes))
      : is_mesh_name(file)
          ? open_meshes(command.files, command.unit.empty() ? "mm" : command.unit, command.fit)
          : open_scene(file);
  if (!opened) return opened.error();
  CheckSubject subject{std::move(*opened), {}};
  if (subject.opened.scenario.assembly)
    subject.step = fs::path(subject.opened.scenario.file).parent_path() /
                   subject.opened.scenario.assembly->file;
  return subject;
}

}  // namespace mortise
