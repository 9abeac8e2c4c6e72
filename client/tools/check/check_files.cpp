#include "client/tools/check/check_files.h"

#include <ctime>
#include <fstream>

#include "client/report/export_files.h"
#include "client/report/export_sqlite.h"
#include "client/tools/check/check_tables.h"

namespace mortise {
namespace {

Status write(const std::string& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << text;
  out.close();
  return out ? ok() : Status(fail(Code::kRuntime, file + ": cannot be written; check the path"));
}

std::string now() {
  const std::time_t seconds = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

}  // namespace

Status write_check_files(const OpenedScene& opened, const CheckReport& report,
                         const CheckCommand& command) {
  Status status = ok();
  const auto put = [&](const std::string& file, auto make) {
    if (status && !file.empty()) status = write(file, make());
  };
  const std::vector<Table> tables = check_tables(opened, report);
  put(command.csv, [&] { return csv_of(table_named(tables, "clashes")); });
  put(command.html, [&] { return check_page(opened, report); });
  put(command.junit, [&] { return check_junit(opened, report); });
  if (status && !command.sqlite.empty()) status = write_sqlite(tables, command.sqlite);
  if (status && !command.bcf.empty())
    status = write_bcf(check_bcf(opened, report, now()), command.bcf);
  return status;
}

}  // namespace mortise
