#include "client/tools/check/run_check.h"

#include "client/tools/check/baseline.h"
#include "client/tools/check/check_text.h"

namespace mortise {

Result<CheckOutcome> run_check(OpenedScene opened, const CheckCommand& command) {
  CheckOutcome outcome{std::move(opened), {}, {}, {}};
  outcome.report = check_scene(outcome.opened, command.check);
  outcome.document = check_json(outcome.opened, outcome.report);
  if (command.baseline.empty()) return outcome;
  Result<std::string> changes = compare_with_baseline(command.baseline, outcome.document);
  if (!changes) return changes.error();
  outcome.changes = std::move(*changes);
  return outcome;
}

Result<CheckOutcome> run_check(const CheckCommand& command) {
  if (const Status good = coherent(command); !good) return good.error();
  Result<OpenedScene> opened = open_check(command);
  if (!opened) return opened.error();
  for (const Finding& finding : opened->findings)
    if (finding.is_error) return fail(Code::kInvalidInput, finding.text);
  return run_check(std::move(*opened), command);
}

}  // namespace mortise
