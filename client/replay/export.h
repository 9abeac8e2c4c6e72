#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "client/replay/session_tables.h"

namespace mortise {

/// The tables as one JSON document: {"tables": {name: [{column: value}]}}.
Json json_of(std::span<const Table> tables);

/// One table as CSV (RFC 4180): a line of names, then the rows; null is an empty field, text that
/// needs it stands in quotes. Numbers as short as they can be read back.
std::string csv_of(const Table& table);

/// One file a table in a folder, which is made.
Status write_csv(std::span<const Table> tables, const std::filesystem::path& folder);

/// A new SQLite database with the tables and the views that client/replay/README.md lists. The file
/// must not exist.
Status write_sqlite(std::span<const Table> tables, const std::filesystem::path& file);

/// One page that needs no other file and no network: summary, timeline, clashes with filters,
/// parts, decisions, coverage. Reads without colour and without script, and prints.
std::string html_of(const std::vector<Table>& tables, const std::string& title);

}  // namespace mortise
