#include "common/io/progress_log.h"
#include "server/json_lines.h"
#include "server/options.h"
#include "server/serve.h"

int main(int argc, char** argv) {
  const mortise::CommandLine line = mortise::read_command_line(argc, argv);
  if (line.exit_code >= 0) return line.exit_code;

  mortise::begin_progress_log("mortise-server", line.options.quiet,
                              line.options.messages == "json" ? mortise::json_lines() : nullptr);
  return mortise::serve(line.options);
}
