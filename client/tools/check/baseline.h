#pragma once
#include <string>

#include "common/base/result.h"
#include "common/io/report_json.h"

namespace mortise {

/// Compares a report with one of before and adds {"baseline": {new, gone, changed, unchanged}} to
/// it. Pairs are the same when their parts have the same paths. Changed: another class, another
/// relation, explained or no longer, or a depth that differs by more than a micrometre. Returns the
/// same as text; an error when the file is no report.
Result<std::string> compare_with_baseline(const std::string& file, Json& report);

/// Did --fail-on find something in the report?
bool fails_on(const std::string& what, const Json& report);

}  // namespace mortise
