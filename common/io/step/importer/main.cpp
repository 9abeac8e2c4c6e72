// mortise-import-step: reads one STEP file for another program of the house and writes what is in
// it to stdout. Not meant for people. It runs alone, with limits, because a hostile file can crash
// the reader, which nothing else links.
#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "common/io/mesh/importer/confined.h"
#include "common/io/step/importer/answer.h"

int main(int argc, char** argv) {
  if (argc != 5) return 2;  // what is asked, file, bytes of memory, seconds
  mortise::confine_this_process(std::strtoull(argv[3], nullptr, 10),
                                std::strtoull(argv[4], nullptr, 10));
  // The library may print: stdout is for the answer alone.
  const int answer = dup(STDOUT_FILENO);
  const int nowhere = open("/dev/null", O_WRONLY);
  if (answer < 0 || nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0) return 1;
  const std::vector<std::byte> said = std::string(argv[1]) == "common"
                                          ? mortise::answer_commons(argv[2], STDIN_FILENO)
                                          : mortise::answer_document(argv[2]);
  const bool well = !said.empty() && mortise::write_all(answer, said);
  _exit(well ? 0 : 1);  // destructors of a damaged document may crash
}
