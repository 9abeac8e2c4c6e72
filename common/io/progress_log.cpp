#include "common/io/progress_log.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdlib>

namespace mortise {
namespace {

spdlog::level::level_enum level_of(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      break;
  }
  return spdlog::level::err;
}

LogMessage message_of(const spdlog::details::log_msg& message) {
  LogLevel level = LogLevel::kDebug;
  if (message.level >= spdlog::level::info) level = LogLevel::kInfo;
  if (message.level >= spdlog::level::warn) level = LogLevel::kWarning;
  if (message.level >= spdlog::level::err) level = LogLevel::kError;
  return {level,
          message.time,
          {message.logger_name.data(), message.logger_name.size()},
          {message.payload.data(), message.payload.size()}};
}

class Lines final : public spdlog::formatter {
 public:
  explicit Lines(LogLine line) : line_(std::move(line)) {}
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& out) override {
    const std::string text = line_(message_of(message));
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<spdlog::formatter> clone() const override {
    return std::make_unique<Lines>(line_);
  }

 private:
  LogLine line_;
};

// The program's own sink guards itself: it is called by others than this one as well.
class Handing final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 public:
  explicit Handing(std::shared_ptr<LogSink> to) : to_(std::move(to)) {}

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    to_->take(message_of(message));
  }
  void flush_() override {}
  std::shared_ptr<LogSink> to_;
};

void begin(const std::string& program, bool quiet, spdlog::sink_ptr sink) {
  auto logger = std::make_shared<spdlog::logger>(program, std::move(sink));
  logger->set_level(quiet ? spdlog::level::warn : spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace

std::string_view name_of(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return "debug";
    case LogLevel::kInfo:
      return "info";
    case LogLevel::kWarning:
      return "warning";
    case LogLevel::kError:
      break;
  }
  return "error";
}

void begin_progress_log(const std::string& program, bool quiet, LogLine line) {
  auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  if (std::getenv("NO_COLOR") != nullptr) sink->set_color_mode(spdlog::color_mode::never);
  if (line) {
    sink->set_formatter(std::make_unique<Lines>(std::move(line)));
  } else {
    sink->set_pattern("%H:%M:%S %^%l%$ %v");
  }
  begin(program, quiet, std::move(sink));
}

void begin_progress_log(const std::string& program, bool quiet, std::shared_ptr<LogSink> sink) {
  begin(program, quiet, std::make_shared<Handing>(std::move(sink)));
}

bool logs(LogLevel level) { return spdlog::should_log(level_of(level)); }

void log_text(LogLevel level, std::string_view text) {
  spdlog::log(level_of(level), spdlog::string_view_t(text.data(), text.size()));
}

}  // namespace mortise
