#include "server/console.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <utility>

#include "common/evaluation/clash_line.h"

namespace mortise {
namespace {

std::string time_of_day(std::chrono::system_clock::time_point time) {
  return fmt::format("{:%H:%M:%S}", fmt::localtime(std::chrono::system_clock::to_time_t(time)));
}

/// The time of day in a file, and "warning: " or "error: " before what is no news.
std::string line_of(const LogMessage& message, const ConsoleStyle& style) {
  std::string line;
  if (!style.terminal) line = time_of_day(message.time) + " ";
  if (message.level >= LogLevel::kWarning) {
    const std::string word{name_of(message.level)};
    const char* const color = message.level == LogLevel::kError ? "\033[31;1m" : "\033[33;1m";
    line += (style.color ? color + word + "\033[0m" : word) + ": ";
  }
  return line.append(message.text) + "\n";
}

}  // namespace

ConsoleStyle style_of_stderr() {
  ConsoleStyle style;
  style.terminal = isatty(STDERR_FILENO) == 1;
  style.color = style.terminal && std::getenv("NO_COLOR") == nullptr;
  winsize window{};
  if (style.terminal && ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0)
    style.columns = window.ws_col;
  return style;
}

Console::Console(std::FILE* out, StyleNow style)
    : out_(out), style_(std::move(style)), style_of_messages_(style_()) {}

void Console::stay(std::vector<std::string> lines) {
  const std::lock_guard lock(mutex_);
  clear();
  lines_ = std::move(lines);
  draw();
  std::fflush(out_);
}

void Console::leave() {
  const std::lock_guard lock(mutex_);
  if (rows_ > 0) std::fputs("\n", out_);
  rows_ = 0;
  lines_.clear();
  std::fflush(out_);
}

void Console::take(const LogMessage& message) {
  const std::string line = line_of(message, style_of_messages_);
  const std::lock_guard lock(mutex_);
  clear();
  std::fwrite(line.data(), 1, line.size(), out_);
  draw();
  std::fflush(out_);
}

void Console::clear() {
  if (rows_ == 0) return;
  std::fputs("\r", out_);
  if (rows_ > 1) std::fprintf(out_, "\033[%zuA", rows_ - 1);
  std::fputs("\033[J", out_);
  rows_ = 0;
}

void Console::draw() {
  const ConsoleStyle style = style_();
  if (!style.terminal) return;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    std::fprintf(out_, "%s%s", lines_[i].c_str(), i + 1 == lines_.size() ? "" : "\n");
    const std::size_t wide = std::max<std::size_t>(columns_of(lines_[i]), 1);
    rows_ += style.columns > 0 ? (wide + style.columns - 1) / style.columns : 1;
  }
}

}  // namespace mortise
