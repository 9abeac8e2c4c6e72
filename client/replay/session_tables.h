#pragma once
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/io/report_json.h"
#include "common/io/session_log.h"

namespace mortise {

/// One table of a session, the same in CSV, JSON, SQLite and HTML. Lengths in mm, angles in rad,
/// times in s; null: nothing is known or nothing bounds it.
struct Table {
  enum class Type { kText, kInteger, kNumber };
  struct Column {
    std::string name;
    Type type = Type::kText;
  };
  std::string name, about;
  std::vector<Column> columns;
  std::vector<std::vector<Json>> rows;  ///< each as long as columns
};

/// session, parts, users, clashes, events, decisions, by_pair, by_part, by_user, coverage: from
/// what the log says, without computing it again. Coverage is not in a log: its counters are those
/// of a recomputation, where there was one, else the table is empty. Cost: one pass; an hour of a
/// busy session takes seconds.
Result<std::vector<Table>> tables_of(const SessionLog& log,
                                     const std::optional<StepCounters>& coverage);

const Table& table_named(const std::vector<Table>& tables, std::string_view name);

}  // namespace mortise
