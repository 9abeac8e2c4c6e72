#pragma once
#include <string>
#include <vector>

#include "client/report/bcf.h"
#include "client/report/session_tables.h"
#include "client/tools/check/check.h"

namespace mortise {

/// The report as tables: clashes, near, not_judged, statements, counts, tree.
std::vector<Table> check_tables(const OpenedScene& opened, const CheckReport& report);

/// A page of them, with a picture of each of the worst clashes: it needs no other file.
std::string check_page(const OpenedScene& opened, const CheckReport& report);

/// A test report (JUnit): a case for each pair that clashes, failed where it is real and not
/// explained, and one for the whole.
std::string check_junit(const OpenedScene& opened, const CheckReport& report);

/// Clashes that nothing explains as issues, with snapshots of the worst. `date`: ISO 8601.
BcfProject check_bcf(const OpenedScene& opened, const CheckReport& report, const std::string& date);

}  // namespace mortise
