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

/// The page of the log in a file; it may still be written.
Result<std::string> report_page(const std::filesystem::path& log);

}  // namespace mortise
