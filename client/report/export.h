#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "client/report/session_tables.h"

namespace mortise {

/// The tables as one JSON document: {"tables": {name: [{column: value}]}}.
Json json_of(std::span<const Table> tables);

/// One table as CSV (RFC 4180): a line of names, then the rows; null is an empty field, text that
/// needs it stands in quotes; text that a spreadsheet would take for a formula stands behind an
/// apostrophe. Numbers as short as they can be read back.
std::string csv_of(const Table& table);

/// One file a table in a folder, which is made.
Status write_csv(std::span<const Table> tables, const std::filesystem::path& folder);

/// A new SQLite database with the tables and the views that client/replay/README.md lists. The file
/// must not exist.
Status write_sqlite(std::span<const Table> tables, const std::filesystem::path& file);

}  // namespace mortise
