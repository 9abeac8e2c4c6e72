#include "client/tools/check/check_command.h"

#include "common/io/mesh/mesh_import.h"
#include "common/io/step/step_import.h"

namespace mortise {

Status coherent(const CheckCommand& o) {
  const auto wrong = [](const std::string& text) { return fail(Code::kInvalidInput, text); };
  const bool step = is_step_name(o.files.front());
  const bool meshes = is_mesh_name(o.files.front()) && !step;
  if (!meshes && o.files.size() > 1)
    return wrong("one assembly, one scenario, or two or more meshes: not " + o.files[0] + " and " +
                 o.files[1]);
  if (!meshes && (!o.fit.empty() || !o.unit.empty()))
    return wrong("--fit and --unit are of meshes; a scenario says them itself");
  if (!step && (o.propose || !o.general.empty() || !o.bought.empty() || !o.session.empty()))
    return wrong("--propose, --general, --bought and --session are of a STEP assembly");
  if (o.session.empty() && !o.fixed.empty()) return wrong("--fix is of --session FILE");
  if (o.fail_on == "new" && o.baseline.empty())
    return wrong("--fail-on new needs --baseline OLD.json");
  for (const std::string& relation : o.check.unexplained) {
    bool known = false;
    for (std::size_t i = 0; i < kMatingKindCount; ++i)
      known |= is_meant_to_overlap(static_cast<MatingKind>(i)) &&
               name_of(static_cast<MatingKind>(i)) == relation;
    if (!known) return wrong("--no-explain: no relation '" + relation + "' explains overlaps");
  }
  return ok();
}

}  // namespace mortise
