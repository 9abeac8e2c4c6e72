#pragma once
#include <filesystem>
#include <span>

#include "client/report/session_tables.h"

namespace mortise {

/// A new SQLite database with the tables and the views that client/replay/README.md lists. The file
/// must not exist.
Status write_sqlite(std::span<const Table> tables, const std::filesystem::path& file);

}  // namespace mortise
