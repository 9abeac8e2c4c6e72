#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "client/report/pictures.h"
#include "client/report/session_tables.h"

namespace mortise {

struct ReportWishes {
  PictureLimits pictures;
  std::optional<StepCounters> coverage;  ///< of a recomputation; else what the log counted itself
  std::vector<Table> more;               ///< of a what-if, behind the others
  std::function<void(double share)> on_progress = {};  ///< of drawing, 0 to 1
};

/// A logged session for people: its tables, and pictures of the worst.
struct SessionReport {
  std::string session;
  std::vector<Table> tables;
  Pictures pictures;
};

/// Cost: that of tables_of and pictures_of.
Result<SessionReport> report_of(const SessionLog& log, const ReportWishes& wishes = {});

/// One page that needs no other file and no network: summary, timeline, clashes with filters, a
/// picture of each of the worst, parts with where they were touched, tolerances, coverage and
/// limits. Reads without colour and without script, and prints.
std::string html_of(const SessionReport& report);

/// The page of the log in a file; it may still be written.
Result<std::string> report_page(const std::filesystem::path& log);

}  // namespace mortise
