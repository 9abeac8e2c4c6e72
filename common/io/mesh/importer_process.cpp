#include "common/io/mesh/importer_process.h"

#include "common/io/mesh/confined_child.h"

namespace mortise {

std::filesystem::path importer_program() {
  return program_beside("MORTISE_IMPORTER", "mortise-import");
}

Result<RawSoup> run_importer(const std::filesystem::path& file, const std::string& extension,
                             const ImportLimits& limits) {
  std::error_code ignored;
  ConfinedChild child;
  child.called = "mesh importer";
  child.where_from = "build the target mortise-import, or set MORTISE_IMPORTER";
  child.program = importer_program();
  child.file = file;
  child.arguments = {std::filesystem::absolute(file, ignored).string(), extension};
  child.limits = limits;
  child.cpu = {10.0, 0.1};
  const Result<MappedBytes> answer = run_confined(child);
  if (!answer) return answer.error();
  return decode(answer->bytes());
}

}  // namespace mortise
