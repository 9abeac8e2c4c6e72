#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdlib>

#include "client/web/options.h"
#include "client/web/run.h"

int main(int argc, char** argv) {
  const mortise::web::WebCommandLine line = mortise::web::read_web_command_line(argc, argv);
  if (line.exit_code >= 0) return line.exit_code;

  // stdout is the result, stderr the progress.
  auto logger = spdlog::stderr_color_mt("mortise-web");
  if (std::getenv("NO_COLOR") != nullptr) {
    static_cast<spdlog::sinks::stderr_color_sink_mt*>(logger->sinks().front().get())
        ->set_color_mode(spdlog::color_mode::never);
  }
  logger->set_pattern("%H:%M:%S %^%l%$ %v");
  logger->set_level(line.options.quiet ? spdlog::level::warn : spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
  return mortise::web::run_web(line.options);
}
