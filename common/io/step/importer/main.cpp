// mortise-import-step: reads one STEP file for another program of the house and writes what is in
// it to stdout. Not meant for people. It runs alone, with limits, because a hostile file can crash
// the reader, which nothing else links.
#include <fcntl.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "common/io/mesh/sandbox.h"
#include "common/io/step/importer/answer.h"

int main(int argc, char** argv) {
  const auto allowed = argc == 4 ? mortise::allowance_of(argv[3]) : std::nullopt;
  if (!allowed) return 2;  // what is asked, file, what it may use
  const bool keeps = std::string(argv[1]) == "keep";
  // The library may print: stdout is for the answer alone.
  const int answer = dup(STDOUT_FILENO);
  const int nowhere = open("/dev/null", O_WRONLY);
  if (answer < 0 || nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0) return 1;
  if (!mortise::enter_sandbox(*allowed, argv[2], keeps)) return 1;
  mortise::StepAnswers answers;
  const std::vector<std::byte> document = answers.document(argv[2]);
  bool well = !document.empty() && mortise::write_all(answer, document);
  if (well && keeps) {  // stdin is a socket (ConfinedDialogue)
    const std::uint64_t length = document.size();
    std::vector<std::byte> word(sizeof length);
    std::memcpy(word.data(), &length, sizeof length);
    well = mortise::write_all(STDIN_FILENO, word) &&
           mortise::write_all(answer, answers.commons(STDIN_FILENO));
  }
  _exit(well ? 0 : 1);  // destructors of a damaged document may crash
}
