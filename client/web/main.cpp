#include "client/web/options.h"
#include "client/web/run.h"
#include "common/io/progress_log.h"

int main(int argc, char** argv) {
  const mortise::web::WebCommandLine line = mortise::web::read_web_command_line(argc, argv);
  if (line.exit_code >= 0) return line.exit_code;

  mortise::begin_progress_log("mortise-web", line.options.quiet);
  return mortise::web::run_web(line.options);
}
