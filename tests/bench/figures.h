#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace mortise::bench {

/// One kept run of a benchmark: {"benchmark", "command", "date", "machine", "report"}, the report
/// as Report::json() makes it.
using KeptRun = nlohmann::ordered_json;

/// The report with what a reader must know of the run: which benchmark, by which command, today, on
/// this machine.
KeptRun kept_run(const std::string& benchmark, const std::string& command,
                 nlohmann::ordered_json report);

/// The run as text, a row of a table a line, so that a difference can be read.
std::string text_of(const KeptRun& run);

/// All runs of a folder (*.json), by name of the benchmark.
std::vector<KeptRun> runs_in(const std::filesystem::path& folder);

/// FIGURES.md: every table and bar of the runs. Lines have at most 160 characters; a wide table is
/// printed in pieces that repeat its first column.
std::string figures_page(const std::vector<KeptRun>& runs);

/// `document` with the text between the two lines "<!-- figures -->" and "<!-- /figures -->"
/// replaced by the table of a few bars of the runs. A bar that no run has is "not measured".
std::string with_figures(const std::string& document, const std::vector<KeptRun>& runs);

}  // namespace mortise::bench
