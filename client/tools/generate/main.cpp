#include "client/tools/generate/options.h"
#include "client/tools/generate/run.h"

int main(int argc, char** argv) {
  const mortise::GenerateCommandLine line = mortise::read_generate_command_line(argc, argv);
  return line.exit_code ? *line.exit_code : mortise::run_generate(line.options);
}
