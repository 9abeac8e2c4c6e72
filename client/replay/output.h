#pragma once
#include "common/base/result.h"
#include "common/io/log/session_log_read.h"
#include "common/io/report_json.h"

namespace mortise {

/// One line on stderr; returns the code.
int say(const Error& error, int exit_code);
/// One document on stdout.
void print(const Json& document);
/// One key and its value a line, on stdout.
void print_lines(const Json& document);
/// The log with further files of its session, or, where none are named, with its chain.
Result<SessionLog> read_files(const std::filesystem::path& log,
                              const std::vector<std::filesystem::path>& more);
/// What a log lacks, on stderr.
void print_notes(const SessionLog& log);

}  // namespace mortise
