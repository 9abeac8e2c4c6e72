#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "client/report/session_tables.h"

namespace mortise {

/// The tables as one JSON document: {"tables": {name: [{column: value}]}}.
Json json_of(std::span<const Table> tables);

/// One table as CSV (RFC 4180): a line of names, then the rows. Null is an empty field, text is
/// quoted where needed, and text that a spreadsheet would take for a formula gets an apostrophe in
/// front. Numbers have as few digits as read back to the same value.
std::string csv_of(const Table& table);

/// One file a table in a folder, which is made.
Status write_csv(std::span<const Table> tables, const std::filesystem::path& folder);

}  // namespace mortise
