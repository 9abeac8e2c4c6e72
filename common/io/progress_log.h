#pragma once
#include <spdlog/common.h>
#include <spdlog/formatter.h>

#include <memory>
#include <string>

namespace mortise {

/// Messages of a program go to stderr, as "12:30:01 info text" or by `form`; stdout is for results.
/// In colours on a terminal, unless NO_COLOR is set. quiet: warnings and errors only.
void begin_progress_log(const std::string& program, bool quiet,
                        std::unique_ptr<spdlog::formatter> form = nullptr);
/// The same to a sink of the program's own.
void begin_progress_log(const std::string& program, bool quiet, spdlog::sink_ptr sink);

}  // namespace mortise
