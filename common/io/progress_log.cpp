#include "common/io/progress_log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdlib>

namespace mortise {

void begin_progress_log(const std::string& program, bool quiet,
                        std::unique_ptr<spdlog::formatter> form) {
  auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  if (std::getenv("NO_COLOR") != nullptr) sink->set_color_mode(spdlog::color_mode::never);
  if (form) {
    sink->set_formatter(std::move(form));
  } else {
    sink->set_pattern("%H:%M:%S %^%l%$ %v");
  }
  begin_progress_log(program, quiet, std::move(sink));
}

void begin_progress_log(const std::string& program, bool quiet, spdlog::sink_ptr sink) {
  auto logger = std::make_shared<spdlog::logger>(program, std::move(sink));
  logger->set_level(quiet ? spdlog::level::warn : spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace mortise
