#include "client/report/report.h"

#include "client/report/export_html.h"
#include "client/report/summary_tables.h"
#include "common/io/log/log_chain.h"

namespace mortise {

Result<SessionReport> report_of(const SessionLog& log, const ReportWishes& wishes) {
  auto tables = tables_of(log, wishes.coverage);
  if (!tables) return tables.error();
  SessionReport report{log.session, std::move(*tables), {}};
  Table& clashes = table_named(report.tables, "clashes");
  report.pictures = pictures_of(log, clashes, wishes.pictures, wishes.on_progress);
  add_circumstances(clashes, report.pictures.circumstances);
  std::vector<Table> more{by_face_table(clashes, report.pictures.touches),
                          tolerance_table(clashes)};
  more.insert(more.end(), wishes.more.begin(), wishes.more.end());
  for (Table& table : more) report.tables.push_back(std::move(table));
  return report;
}

Result<std::string> report_page(const std::filesystem::path& log) {
  const auto read = read_session(log);
  if (!read) return read.error();
  const auto report = report_of(*read);
  if (!report) return report.error();
  return html_of(*report);
}

}  // namespace mortise
