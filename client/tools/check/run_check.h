#pragma once
#include <string>

#include "client/tools/check/check_command.h"
#include "client/tools/check/open_check.h"
#include "common/io/report_json.h"

namespace mortise {

/// A check from its files to its report, as the program and other callers have it.
struct CheckOutcome {
  OpenedScene opened;
  CheckReport report;
  Json document;        ///< of --json, with the changes against the baseline
  std::string changes;  ///< the same changes for people
};

/// Opens, judges and compares. Writes no file and says nothing; what was found while reading is in
/// opened.findings. Fails when the wishes do not go together, a file cannot be used (then
/// with the first finding that is an error), or the baseline is no report.
Result<CheckOutcome> run_check(const CheckCommand& command);

/// The same of what is open already.
Result<CheckOutcome> run_check(OpenedScene opened, const CheckCommand& command);

}  // namespace mortise
