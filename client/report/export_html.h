#pragma once
#include <string>

#include "client/report/report.h"

namespace mortise {

/// One page that needs no other file and no network: summary, timeline, clashes with filters, a
/// picture of each of the worst, parts with where they were touched, tolerances, coverage and
/// limits. Reads without colour and without script, and prints.
std::string html_of(const SessionReport& report);

}  // namespace mortise
