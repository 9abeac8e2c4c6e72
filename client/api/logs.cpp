#include <mortise/io.h>

#include <limits>

#include "client/api/convert.h"
#include "client/api/judgement.h"
#include "client/report/session_tables.h"
#include "common/io/log/log_chain.h"
#include "common/io/log/replay.h"

namespace mortise::api {
namespace {

Column column_of(const mortise::Table& table, std::size_t index) {
  const mortise::Table::Column& named = table.columns[index];
  Column column;
  column.name = named.name;
  column.is_text = named.type == mortise::Table::Type::kText;
  for (const auto& row : table.rows) {
    const mortise::Json& cell = row[index];
    if (column.is_text)
      column.texts.push_back(cell.is_string() ? cell.get<std::string>()
                             : cell.is_null() ? std::string()
                                              : cell.dump());
    else
      column.numbers.push_back(cell.is_number()    ? cell.get<double>()
                               : cell.is_boolean() ? (cell.get<bool>() ? 1.0 : 0.0)
                                                   : std::numeric_limits<double>::quiet_NaN());
  }
  return column;
}

}  // namespace

Result<Log> read_log(const std::string& file) {
  const mortise::Result<mortise::SessionLog> read = mortise::read_session(file);
  if (!read) return error_of(read.error());
  const mortise::Result<std::vector<mortise::Table>> tables =
      mortise::tables_of(*read, std::nullopt);
  if (!tables) return error_of(tables.error());
  Log log;
  log.session = read->session;
  log.complete = read->complete;
  log.notes = read->notes;
  for (const mortise::Table& table : *tables) {
    Table out{table.name, table.about, {}};
    for (std::size_t i = 0; i < table.columns.size(); ++i)
      out.columns.push_back(column_of(table, i));
    log.tables.push_back(std::move(out));
  }
  return log;
}

Result<std::uint64_t> verify_log(const std::string& file, int threads) {
  if (!is_thread_count(threads))
    return Error{Code::kInvalidInput, "threads must lie between 1 and 256"};
  const mortise::Result<mortise::SessionLog> read = mortise::read_session(file);
  if (!read) return error_of(read.error());
  const mortise::Result<mortise::ReplayReport> report = mortise::verify(*read, threads);
  if (!report) return error_of(report.error());
  if (report->difference)
    return Error{Code::kMismatch, file + ": tick " + std::to_string(report->difference->tick) +
                                      ": " + report->difference->what};
  if (!report->not_verifiable.empty())
    return Error{Code::kInvalidInput, file + ": " + report->not_verifiable};
  return report->verified_to_tick;
}

}  // namespace mortise::api
