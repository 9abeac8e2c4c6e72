#pragma once
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/io/log/session_log_read.h"
#include "common/io/report_json.h"

namespace mortise {

/// One table of a session, the same in CSV, JSON, SQLite and HTML. Lengths in mm, angles in rad,
/// times in s; null: unknown or unbounded.
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

/// session, parts, users, exclusions, clashes, events, decisions, tick_times, by_pair, by_part,
/// by_user, coverage: from the log, without computing it again. Coverage: the counters of a
/// recomputation, or else those in the log. A clash is real until the zones of its faces are wider
/// by real_until_widened_mm to each side (negative: it would be real if they were narrower by that
/// much), fake likewise. Costs one pass.
Result<std::vector<Table>> tables_of(const SessionLog& log,
                                     const std::optional<StepCounters>& coverage);

const Table& table_named(const std::vector<Table>& tables, std::string_view name);
Table& table_named(std::vector<Table>& tables, std::string_view name);

}  // namespace mortise
