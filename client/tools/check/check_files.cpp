#include "client/tools/check/check_files.h"

#include <ctime>
#include <fstream>

#include "client/report/export_files.h"
#include "client/report/export_sqlite.h"
#include "client/tools/check/check_tables.h"
#include "client/tools/check/open_check.h"
#include "common/io/scenario/session_scenario.h"

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

// A scenario for a session of the assembly: what is explained, and what the exact solids say is no
// clash, is approved where it stands.
Result<std::string> session_of(const OpenedScene& opened, const CheckReport& report,
                               const CheckCommand& command) {
  const std::filesystem::path step = command.files.front(), beside = statements_beside(step);
  Result<std::string> text = assembly_yaml(step, {});
  if (std::filesystem::exists(beside)) text = scenario_text(beside);
  if (!text) return text.error();
  std::vector<Scenario::PairReason> approvals;
  for (const CheckedPair& pair : report.pairs) {
    if (pair.reason.empty() || (!pair.explained && !pair.is_contact)) continue;
    for (const auto& [a, b] : pair.all)
      approvals.push_back(
          {opened.scene.world.find(a)->name, opened.scene.world.find(b)->name, pair.reason, {}});
  }
  return session_scenario(*text, step.parent_path(),
                          {command.general, command.bought, command.fixed, {}}, approvals);
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
  if (status && !command.session.empty()) {
    const Result<std::string> text = session_of(opened, report, command);
    status = text ? write(command.session, *text) : Status(text.error());
  }
  return status;
}

}  // namespace mortise
