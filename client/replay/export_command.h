#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace mortise {

/// The session as tables (client/report/session_tables.h); what is empty is not written.
struct ExportOptions {
  std::filesystem::path log;
  std::vector<std::filesystem::path> more;
  std::filesystem::path csv;  ///< a folder
  std::filesystem::path sqlite, html, json, bcf;
  std::filesystem::path scenario;  ///< a new folder
  std::vector<std::string> sweep;  ///< what-if of the page; see WhatIfOptions
  bool recompute = false;          ///< for coverage
  bool only_scenario() const {
    return csv.empty() && sqlite.empty() && html.empty() && json.empty() && bcf.empty();
  }
};
int run_export(const ExportOptions& options);

/// A session that was saved as an archive (client/saved), as a folder.
struct UnpackOptions {
  std::filesystem::path archive, out;
};
int run_unpack(const UnpackOptions& options);

}  // namespace mortise
