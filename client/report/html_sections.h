#pragma once
#include <string>

#include "client/report/report.h"

namespace mortise {

/// Sections of the page that are more than a table.
std::string letter_of(const std::string& klass);
std::string picture_section(const SessionReport& report);
std::string part_section(const SessionReport& report);
std::string tolerance_section(const SessionReport& report);
std::string limits_section(const SessionReport& report);

/// A table as it stands; nothing where it has no rows. Of long ones the first rows, and how many
/// there are.
std::string plain_table(const Table& table, const std::string& title);

}  // namespace mortise
