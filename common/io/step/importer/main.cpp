// mortise-import-step: reads one STEP file for another program of the house and writes what is in
// it to stdout. Not meant for people. It runs alone, with limits, because a hostile file can crash
// the reader, which nothing else links.
#include <fcntl.h>
#include <unistd.h>

#include <optional>
#include <string>

#include "common/io/mesh/sandbox.h"
#include "common/io/step/importer/answer.h"

int main(int argc, char** argv) {
  const auto allowed = argc == 4 ? mortise::allowance_of(argv[3]) : std::nullopt;
  if (!allowed) return 2;  // what is asked, file, what it may use
  const bool asks_commons = std::string(argv[1]) == "common";
  // The library may print: stdout is for the answer alone.
  const int answer = dup(STDOUT_FILENO);
  const int nowhere = open("/dev/null", O_WRONLY);
  if (answer < 0 || nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0) return 1;
  if (!mortise::enter_sandbox(*allowed, argv[2], asks_commons)) return 1;
  const std::vector<std::byte> said = asks_commons ? mortise::answer_commons(argv[2], STDIN_FILENO)
                                                   : mortise::answer_document(argv[2]);
  const bool well = !said.empty() && mortise::write_all(answer, said);
  _exit(well ? 0 : 1);  // destructors of a damaged document may crash
}
