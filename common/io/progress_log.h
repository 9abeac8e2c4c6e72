#pragma once
#include <fmt/core.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace mortise {

enum class LogLevel : std::uint8_t { kDebug, kInfo, kWarning, kError };

/// "debug", "info", "warning", "error".
std::string_view name_of(LogLevel level);

struct LogMessage {
  LogLevel level = LogLevel::kInfo;
  std::chrono::system_clock::time_point time;
  std::string_view program, text;
};

/// A message as the line that is written, with its end of line.
using LogLine = std::function<std::string(const LogMessage&)>;

/// Where a program puts its messages itself. Called from any thread.
class LogSink {
 public:
  virtual ~LogSink() = default;
  virtual void take(const LogMessage& message) = 0;
};

/// Messages of a program go to stderr, as "12:30:01 info text" or as `line` makes them; stdout is
/// for results. In colours on a terminal, unless NO_COLOR is set. quiet: warnings and errors only.
void begin_progress_log(const std::string& program, bool quiet, LogLine line = nullptr);
/// The same to a sink of the program's own.
void begin_progress_log(const std::string& program, bool quiet, std::shared_ptr<LogSink> sink);

/// Is a message of that level written? One that is not costs no formatting.
bool logs(LogLevel level);
void log_text(LogLevel level, std::string_view text);

template <class... Values>
void log_at(LogLevel level, fmt::format_string<Values...> form, Values&&... values) {
  if (logs(level)) log_text(level, fmt::format(form, std::forward<Values>(values)...));
}
template <class... Values>
void log_debug(fmt::format_string<Values...> form, Values&&... values) {
  log_at(LogLevel::kDebug, form, std::forward<Values>(values)...);
}
template <class... Values>
void log_info(fmt::format_string<Values...> form, Values&&... values) {
  log_at(LogLevel::kInfo, form, std::forward<Values>(values)...);
}
template <class... Values>
void log_warning(fmt::format_string<Values...> form, Values&&... values) {
  log_at(LogLevel::kWarning, form, std::forward<Values>(values)...);
}
template <class... Values>
void log_error(fmt::format_string<Values...> form, Values&&... values) {
  log_at(LogLevel::kError, form, std::forward<Values>(values)...);
}

}  // namespace mortise
