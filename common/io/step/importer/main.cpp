// mortise-import-step: reads one STEP file for another program of the house and writes what is in
// it to stdout. Not meant for people. It runs alone, with limits, because a hostile file can crash
// the reader, which nothing else links.
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "common/io/step/importer/answer.h"

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitsMemory = false;  // sanitizers reserve terabytes of address space
#else
constexpr bool kLimitsMemory = true;
#endif

void limit(int what, rlim_t most) {
  const rlimit both{most, most};
  setrlimit(static_cast<__rlimit_resource_t>(what), &both);
}

bool write_all(int file, const std::vector<std::byte>& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = write(file, bytes.data() + done, bytes.size() - done);
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;  // what is asked, file, bytes of memory, seconds
  const rlim_t bytes = std::strtoull(argv[3], nullptr, 10);
  const rlim_t seconds = std::strtoull(argv[4], nullptr, 10);
  if (kLimitsMemory) limit(RLIMIT_AS, bytes);
  limit(RLIMIT_FSIZE, bytes);
  limit(RLIMIT_CPU, seconds + 1);
  limit(RLIMIT_CORE, 0);
  // The library may print: stdout is for the answer alone.
  const int answer = dup(STDOUT_FILENO);
  const int nowhere = open("/dev/null", O_WRONLY);
  if (answer < 0 || nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0) return 1;
  const std::vector<std::byte> said = std::string(argv[1]) == "common"
                                          ? mortise::answer_commons(argv[2], STDIN_FILENO)
                                          : mortise::answer_document(argv[2]);
  const bool well = !said.empty() && write_all(answer, said);
  _exit(well ? 0 : 1);  // destructors of a damaged document may crash
}
