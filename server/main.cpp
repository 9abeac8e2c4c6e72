#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdlib>

#include "server/json_lines.h"
#include "server/options.h"
#include "server/serve.h"

int main(int argc, char** argv) {
  const mortise::CommandLine line = mortise::read_command_line(argc, argv);
  if (line.exit_code >= 0) return line.exit_code;

  // stdout is the result, stderr the progress.
  auto logger = spdlog::stderr_color_mt("mortise-server");
  if (std::getenv("NO_COLOR") != nullptr) {
    static_cast<spdlog::sinks::stderr_color_sink_mt*>(logger->sinks().front().get())
        ->set_color_mode(spdlog::color_mode::never);
  }
  if (line.options.messages == "json") {
    logger->set_formatter(mortise::json_lines());
  } else {
    logger->set_pattern("%H:%M:%S %^%l%$ %v");
  }
  logger->set_level(line.options.quiet ? spdlog::level::warn : spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
  return mortise::serve(line.options);
}
