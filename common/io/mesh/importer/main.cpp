// mortise-import: reads one mesh file for another program of the house and writes its triangles to
// stdout. Not meant for people. It runs alone, with limits, because a hostile file can crash the
// reader.
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <new>
#include <string>

#include "common/io/mesh/importer/read_with_assimp.h"

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

bool write_all(const std::vector<std::byte>& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = write(STDOUT_FILENO, bytes.data() + done, bytes.size() - done);
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;  // file, extension, bytes of memory, seconds
  const rlim_t bytes = std::strtoull(argv[3], nullptr, 10);
  if (kLimitsMemory) limit(RLIMIT_AS, bytes);
  limit(RLIMIT_FSIZE, bytes);
  limit(RLIMIT_CPU, std::strtoull(argv[4], nullptr, 10) + 1);
  limit(RLIMIT_CORE, 0);
  mortise::RawSoup soup;
  try {
    soup = mortise::read_with_assimp(argv[1], argv[2]);
    return write_all(mortise::encode(soup)) ? 0 : 1;
  } catch (const std::bad_alloc&) {
    soup = {};
    soup.refusal = "std::bad_alloc";
  } catch (const std::exception& error) {
    soup = {};
    soup.refusal = error.what();
  }
  return write_all(mortise::encode(soup)) ? 0 : 1;
}
