#include "server/console.h"

#include <spdlog/pattern_formatter.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "common/evaluation/clash_line.h"

namespace mortise {
namespace {

/// The time of day in a file, and "warning: " or "error: " before what is no news.
class ConsoleLines final : public spdlog::formatter {
 public:
  explicit ConsoleLines(const ConsoleStyle& style)
      : style_(style), time_("%H:%M:%S ", spdlog::pattern_time_type::local, "") {}
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& out) override {
    if (!style_.terminal) time_.format(message, out);
    if (message.level >= spdlog::level::warn) {
      const bool error = message.level >= spdlog::level::err;
      const std::string word = error ? "error" : "warning";
      append(style_.color ? (error ? "\033[31;1m" : "\033[33;1m") + word + "\033[0m" : word, out);
      append(": ", out);
    }
    out.append(message.payload.data(), message.payload.data() + message.payload.size());
    append("\n", out);
  }
  std::unique_ptr<spdlog::formatter> clone() const override {
    return std::make_unique<ConsoleLines>(style_);
  }

 private:
  static void append(const std::string& text, spdlog::memory_buf_t& out) {
    out.append(text.data(), text.data() + text.size());
  }
  ConsoleStyle style_;
  spdlog::pattern_formatter time_;
};

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

std::unique_ptr<spdlog::formatter> console_lines(const ConsoleStyle& style) {
  return std::make_unique<ConsoleLines>(style);
}

Console::Console(std::FILE* out, StyleNow style) : out_(out), style_(std::move(style)) {
  set_formatter_(console_lines(style_()));
}

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

void Console::sink_it_(const spdlog::details::log_msg& message) {
  spdlog::memory_buf_t line;
  formatter_->format(message, line);
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
