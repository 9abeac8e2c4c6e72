#include <memory>

#include "common/io/progress_log.h"
#include "server/console.h"
#include "server/json_lines.h"
#include "server/options.h"
#include "server/serve.h"

int main(int argc, char** argv) {
  const mortise::CommandLine line = mortise::read_command_line(argc, argv);
  if (line.exit_code >= 0) return line.exit_code;

  const mortise::ServerOptions& options = line.options;
  std::shared_ptr<mortise::Console> console;
  if (options.messages == "json") {
    mortise::begin_progress_log("mortise-server", options.quiet, mortise::json_line);
  } else {
    console = std::make_shared<mortise::Console>();
    mortise::begin_progress_log("mortise-server", options.quiet, console);
  }
  return mortise::serve(options, console.get());
}
